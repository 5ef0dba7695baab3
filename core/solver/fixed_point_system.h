// Equations x = G(x) as a solver sees them.
#pragma once

#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// A system x = G(x), G evaluated Jacobi style (all of G(x) from x alone), with its Jacobian G' = T + K
/// in two parts: T with the generator B frozen, K through B.
class FixedPointSystem {
 public:
  virtual ~FixedPointSystem() = default;

  /// R = G(x) - x, formed in double and rounded to single precision.  May truncate x to its bands, and
  /// leave out of G(x) what counts for less than `accuracy`.  Keeps what linearise() takes.  Returns
  /// the change of a Picard sweep: the largest Frobenius norm over the unknowns, and over what else
  /// the published form bounds; NaN if any is.
  virtual double residual(Unknowns& x, double accuracy, Corrections& R) = 0;

  /// Fixes T and K at the x of the last residual, in single precision, to a relative accuracy.
  virtual void linearise(double accuracy) = 0;

  /// A sweep with B frozen: delta <- rhs + T delta, or, where solves_frozen(), the solution of
  /// delta = rhs + T delta.  Returns the largest Frobenius norm of a change of delta.
  virtual double frozen_sweep(const Corrections& rhs, Corrections& delta) = 0;
  virtual bool solves_frozen() const { return false; }

  /// coupled = K delta.
  virtual void couple(const Corrections& delta, Corrections& coupled) = 0;
};

}  // namespace isosyrk
