// The integrator of the fast forms: a stage system, a predictor and solvers with fallbacks.
#pragma once

#include <memory>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/anderson.h"
#include "isosyrk/solver/inexact_newton.h"
#include "isosyrk/solver/predictor.h"

namespace isosyrk {

/// A one-step method in split-complex storage.  It gives the answer of the published form to the
/// solver's tolerance.
///
/// A step is accepted by the rule of solve_fixed_point, on the change of a Picard sweep in double
/// precision, whatever the start values.  Attempts are made in this order until one converges:
/// predicted Newton, cold Newton, cold Picard with frozen sweeps, cold Anderson.  Without
/// FastOptions::newton they are predicted Picard, cold Picard and cold Anderson.  There is no
/// predicted attempt after a failed step, for another h, or from a state other than the last W₁.
class FastIntegrator final : public Integrator {
 public:
  /// Takes the system, made for this flow and for at least options.threads threads.  Throws
  /// std::invalid_argument for options out of range.
  FastIntegrator(const Flow& flow, std::unique_ptr<StageSystem> system, const FastOptions& options);

  /// Returns the change of one more Picard sweep, without band truncation, from the unknowns of the
  /// last step, which must have converged.  Checks the tolerance independently of the solver.
  double change_of_one_more_sweep();

  int threads() const { return options_.threads; }
  /// True if products skip entries outside bands.
  bool truncates() const { return system_->truncates(); }

 protected:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) override;

 private:
  // Makes the attempts in order and returns the report of the last, with the sweeps of all.
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
