// The interface between solvers and equations x = G(x).
#pragma once

#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// A system x = G(x) with the Jacobian G' = T + K.  T is the Jacobian with B frozen, K the coupling
/// through B.  G is evaluated Jacobi style: all of G(x) from x alone.
class FixedPointSystem {
 public:
  virtual ~FixedPointSystem() = default;

  /// Sets R = G(x) - x, formed in double and rounded to single precision.  Returns the change of a
  /// Picard sweep: the largest Frobenius norm over the unknowns and over any further quantity that
  /// the published form bounds, or NaN if any norm is NaN.  May truncate x to its bands, and
  /// neglect terms of G(x) below `accuracy`.  Stores the data of linearise().
  virtual double residual(Unknowns& x, double accuracy, Corrections& R) = 0;

  /// Fixes T and K at the x of the last residual(), in single precision, to a relative accuracy.
  virtual void linearise(double accuracy) = 0;

  /// Makes a sweep with B frozen, delta <- rhs + T delta.  If solves_frozen(), delta becomes the
  /// solution of delta = rhs + T delta instead.  Returns the largest Frobenius norm of a change of
  /// delta, or NaN if any norm is NaN.
  virtual double frozen_sweep(const Corrections& rhs, Corrections& delta) = 0;
  /// True if one frozen_sweep() solves the equation with B frozen.
  virtual bool solves_frozen() const { return false; }

  /// coupled = K delta.
  virtual void couple(const Corrections& delta, Corrections& coupled) = 0;
};

}  // namespace isosyrk
