// The interface between solvers and equations x = G(x).
#pragma once

#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/iteration/status.h"
#include "isosyrk/solver/acceptance.h"
#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Sizes of a residual R = G(x) - x.
struct ResidualSize {
  /// Change of a Picard sweep: the largest Frobenius norm over the unknowns, and over any further
  /// quantity that the published form bounds.  NaN if any norm is NaN.
  double change;
  /// Bound on the terms of G(x) that were neglected, in the same norm.
  double neglected;
};

/// The part of the Jacobian by which a correction improves on R.
enum class JacobianPart {
  whole,
  frozen,  ///< the Jacobian with B frozen, applied Tuning::frozen_sweeps times; no coupling
};

/// What is asked of a correction.
struct CorrectionRequest {
  double size;          ///< norm of R
  double forcing_term;  ///< error allowed in the correction
  JacobianPart part = JacobianPart::whole;
};

/// What became of a correction.
struct Correction {
  bool usable = false;  ///< false if it could not be computed; delta is then unspecified
  double error = 0.0;   ///< estimated error of delta as solution of (1 - G') delta = R
};

/// A system x = G(x).  A solver knows no more of it than this.
class FixedPointSystem {
 public:
  virtual ~FixedPointSystem() = default;

  /// Sets R = G(x) - x, formed in double and rounded to single precision.  May truncate x to its
  /// bands, and neglect terms of G(x) that are `accuracy` together.
  virtual ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) = 0;

  /// Sets delta to a solution of (1 - G'(x)) delta = R, where x and R are those of the last
  /// residual().  The system chooses how: see AlternatingCorrection and NeumannCorrection.
  /// options.after_sweep is called after each of its inner sweeps.
  virtual Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                             const CorrectionRequest& request, const IterationOptions& options) = 0;

  /// Returns the size of x to which the tolerance is relative.
  virtual double unit(const Unknowns&) const { return 1.0; }

  /// Returns a factor by which a Picard sweep contracts the error of any x, or less.  Earlier steps
  /// may have shown a lesser one, where their errors had a symmetry.
  virtual double least_contraction() const { return 0.0; }

  /// Returns the rule by which a solver accepts x.
  virtual Acceptance acceptance() const { return {}; }
};

}  // namespace isosyrk
