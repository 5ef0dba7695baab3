// Stage system: the stage equations of one step of a fast form.
#pragma once

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The equations x = G(x) of one step W₀ -> W₁ of size h, for flows with J = I.  Independent of
/// solvers, predictors and attempts.
///
/// Order of calls in a step:
///   1. bind;
///   2. cold_start, or an x from the predictor;
///   3. residual, linearise, frozen_sweep and couple, any number of times: linearise after a
///      residual, frozen_sweep and couple after linearise;
///   4. update, with the x that the solver accepted.
/// After a failed attempt, 2 and 3 are repeated.
class StageSystem : public FixedPointSystem {
 public:
  /// Returns zero unknowns of the right shapes.
  virtual Unknowns unknowns() const = 0;

  /// Begins a step from W₀ of size h, to be solved to the tolerance.  W₀ must stay unchanged until
  /// update().
  virtual void bind(const SplitMatrix& W0, double h, double tolerance) = 0;

  /// Sets x to the start values of a cold start: Q = I, P = W₀, X = M = 0, W̃ = W₀.
  virtual void cold_start(Unknowns& x) = 0;

  /// Computes W₁ from the accepted x: the x of the last residual() plus that residual.
  virtual void update(const Unknowns& x, SplitMatrix& W1) = 0;

  /// True if products skip entries outside bands.
  virtual bool truncates() const = 0;
  /// Switches band truncation on or off.
  virtual void truncate(bool enabled) = 0;

  /// Returns products, Poisson solves and equivalent products since construction.
  virtual StepReport work() const = 0;
};

}  // namespace isosyrk
