// What a solver asks of a residual and of a correction, and what it is told of them.
#pragma once

namespace isosyrk {

/// Sizes of a residual R = G(x) - x.
struct ResidualSize {
  /// Change of a Picard sweep: the largest Frobenius norm over the unknowns, and over any further
  /// quantity that the published form bounds.  NaN if any norm is NaN.
  double change;
  /// Bound on the terms of G(x) that were neglected, in the same norm.
  double neglected;
};

/// What is asked of a correction.
struct CorrectionRequest {
  double size;          ///< norm of R
  double forcing_term;  ///< error allowed in the correction
};

/// Outcome of a correction.
struct Correction {
  bool usable = false;  ///< false if it could not be computed; delta is then unspecified
  double error = 0.0;   ///< estimated error of delta as solution of (1 - G') delta = R
};

}  // namespace isosyrk
