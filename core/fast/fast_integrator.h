// The integrator of the fast forms: stage system, predictor, solvers and fallbacks put together.
#pragma once

#include <memory>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/anderson.h"
#include "isosyrk/solver/inexact_newton.h"
#include "isosyrk/solver/predictor.h"

namespace isosyrk {

/// A one-step method in split-complex storage: the answer of the published form to the solver's
/// tolerance, sooner.
///
/// A step is accepted by the rule of solve_fixed_point, on the change of a Picard sweep in double
/// precision, so that what is accepted is as good as from a cold start.  A list of attempts is walked
/// until one converges: predicted Newton, cold Newton, cold Picard with frozen sweeps, cold Anderson.
/// There is no prediction after a failed step, for a step of another size, and from another state
/// than the last step ended at.
class FastIntegrator final : public Integrator {
 public:
  /// Takes the system, made for flow.size() and for as many threads.  Throws std::invalid_argument
  /// for options out of range.
  FastIntegrator(const Flow& flow, std::unique_ptr<StageSystem> system, const FastOptions& options);

  /// The change that one more Picard sweep, without truncation, makes to the unknowns with which the
  /// last step was accepted: what the tolerance bounds, seen from outside the solver.
  double change_of_one_more_sweep();

  int threads() const { return options_.threads; }
  bool truncates() const { return system_->truncates(); }

 protected:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) override;

 private:
  // Walks the list of attempts; the report is of the last one, with the sweeps of all.
  StepReport solve(double h);
  SolveReport solve(Iteration iteration);
  SolveReport anderson();

  std::unique_ptr<StageSystem> system_;
  FastOptions options_;
  SplitMatrix W0_, W1_;
  double h_ = 0.0;  // of the last step
  Unknowns x_;
  InexactNewton solver_;
  Anderson anderson_;
  Predictor predictor_;
};

}  // namespace isosyrk
