// The stage equations of one step of a fast form.
#pragma once

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The equations x = G(x) of one step W₀ -> W₁ of size h, for flows with J = I.  Knows nothing of
/// solvers, predictors, attempts and threads.
///
/// Order of calls: bind; cold_start, or x from elsewhere; residual, linearise, frozen_sweep and couple
/// as the solver pleases; update with the x that the solver accepted.
class StageSystem : public FixedPointSystem {
 public:
  /// Unknowns of the right shapes, zero.
  virtual Unknowns unknowns() const = 0;

  /// The step begins: W₀, which must stay until update, h and the tolerance of the solver.
  virtual void bind(const SplitMatrix& W0, double h, double tolerance) = 0;

  /// The x of a cold start: Q = I, P = W₀, X = M = 0, W̃ = W₀.
  virtual void cold_start(Unknowns& x) = 0;

  /// W₁ from the accepted x, which differs from the x of the last residual by that residual.
  virtual void update(const Unknowns& x, SplitMatrix& W1) = 0;

  /// Whether products leave out what lies outside of bands.
  virtual bool truncates() const = 0;
  virtual void truncate(bool enabled) = 0;

  /// Products, Poisson solves and equivalent products since construction.
  virtual StepReport work() const = 0;
};

}  // namespace isosyrk
