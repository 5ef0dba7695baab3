// Corrections by a Neumann series, for a Jacobian that contracts and has no part with B frozen.
#pragma once

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The Jacobian K = G' of a system x = G(x) that is coupled through B alone.
class Coupling {
 public:
  virtual ~Coupling() = default;
  /// coupled = K delta at the x of the last residual(), with an error of at most `accuracy` in the
  /// largest Frobenius norm.
  virtual void couple(Corrections& coupled, const Corrections& delta, double accuracy) = 0;
};

/// Sums delta = R + K R + K² R + ..., each term to the accuracy that delta still needs.
class NeumannCorrection {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit NeumannCorrection(const Unknowns& like);

  /// Sums until the estimated rest of the series is below the forcing term, or Tuning::inner_sweeps
  /// terms are added.  Not usable if a term is as large as both before it.
  Correction solve(Corrections& delta, Coupling& coupling, const Corrections& R,
                   const CorrectionRequest& request, const IterationOptions& options);

 private:
  Corrections term_, next_;  // K^k R and K^(k+1) R
};

}  // namespace isosyrk
