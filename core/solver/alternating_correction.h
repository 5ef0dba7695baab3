// Corrections by a Jacobian in two parts, of which one contracts slowly and one smooths.
#pragma once

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The Jacobian G' = T + K of a system x = G(x): T with B frozen, K the coupling through B.
class TwoPartJacobian {
 public:
  virtual ~TwoPartJacobian() = default;

  /// Fixes T and K at the x of the last residual(), in single precision.  They may have this
  /// relative error.
  virtual void linearise(const Unknowns& x, double accuracy) = 0;

  /// Makes a sweep with B frozen, delta <- rhs + T delta.  If solves_frozen(), delta becomes the
  /// solution of delta = rhs + T delta instead.  Returns the largest Frobenius norm of a change of
  /// delta, or NaN if any norm is NaN.
  virtual double frozen_sweep(Corrections& delta, const Corrections& rhs) = 0;
  /// True if one frozen_sweep() solves the equation with B frozen.
  virtual bool solves_frozen() const { return false; }

  /// coupled = K delta.
  virtual void couple(Corrections& coupled, const Corrections& delta) = 0;
};

/// Solves (1 - T - K) delta = R by alternating frozen sweeps and couplings.
class AlternatingCorrection {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit AlternatingCorrection(const Unknowns& like);

  /// Linearises at x and solves for delta, from delta = R.  Reduces the larger of two estimated
  /// errors, that with B frozen and that of the coupling, until both together are below the forcing
  /// term or Tuning::inner_sweeps are made.  Not usable if the sweeps do not contract.
  Correction solve(Corrections& delta, TwoPartJacobian& jacobian, const Unknowns& x,
                   const Corrections& R, const CorrectionRequest& request,
                   const IterationOptions& options);

  /// Linearises at x and makes Tuning::frozen_sweeps frozen sweeps from delta = R: what a system
  /// moves by far from the solution.  T contracts slowly in the fine scales, and a further
  /// application of it makes longer steps converge.
  static void sweep_frozen(Corrections& delta, TwoPartJacobian& jacobian, const Unknowns& x,
                           const Corrections& R, const IterationOptions& options);

 private:
  // rhs_ <- R + K delta and delta <- delta + rhs_ - rhs, with the rhs of the sweeps before.
  // Returns the largest norm of the change of delta.
  double couple(Corrections& delta, TwoPartJacobian& jacobian, const Corrections& R,
                const Corrections& rhs);

  Corrections rhs_;      // R + K delta, the right-hand side of frozen sweeps
  Corrections coupled_;  // K delta
};

}  // namespace isosyrk
