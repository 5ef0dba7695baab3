// One substep of a fast integrator: a stage system, its predictor and solvers with fallbacks.
#pragma once

#include <memory>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/solver/anderson.h"
#include "isosyrk/solver/inexact_newton.h"
#include "isosyrk/solver/predictor.h"

namespace isosyrk {

/// Solves the stage equations of a step W₀ -> W₁ in split-complex storage.
///
/// A step is accepted by the rule of solve_fixed_point, on the change of a Picard sweep in double
/// precision, whatever the start values.  Attempts are made in this order until one converges:
/// predicted Newton, cold Newton, cold Picard with frozen sweeps, cold Anderson.  Without
/// FastOptions::newton they are predicted Picard, cold Picard and cold Anderson.  There is no
/// predicted attempt after a failed step, for another h, or after forget().
///
/// The predictor keeps its past steps where a predicted attempt fails and a cold one works.  In
/// runs of 60 steps of h‖B‖ >= 1.5, where predictions fail (all forms with s <= 3; both scenes at n
/// = 17, in part the smooth one at n = 33), this took 10 % fewer sweeps and 4 % fewer products than
/// forgetting them, in the geometric mean.  Single cells go either way.
class FastSubstep {
 public:
  FastSubstep(std::unique_ptr<StageSystem> system, const FastOptions& options);

  /// Computes W₁ from W₀ by a step of size h.  The report has status, attempt and sweeps.  W₀ must
  /// be the W₁ of the call before, or forget() must be called first.
  StepReport advance(const SplitMatrix& W0, double h, SplitMatrix& W1);
  /// The same from any W₀ by a cold start.  Past steps stay as they are.
  StepReport advance_alone(const SplitMatrix& W0, double h, SplitMatrix& W1);
  /// Forgets all past steps.
  void forget() { predictor_.forget(); }

  /// Returns the change of one more Picard sweep, without band truncation, from the unknowns of the
  /// last step, which must have converged from W₀ with this h.
  double change_of_one_more_sweep(const SplitMatrix& W0, double h);

  const StageSystem& system() const { return *system_; }

 private:
  // Makes one attempt from x_, and adds it to the report.  True if it converged.
  bool converges(Attempt attempt, StepReport& report);
  // Makes the cold attempts in order until one converges.
  void solve_cold(StepReport& report);
  SolveReport solve(Iteration iteration);
  SolveReport anderson();

  std::unique_ptr<StageSystem> system_;
  FastOptions options_;
  Iteration first_;  // of an attempt, unless it is a fallback
  Unknowns x_;
  InexactNewton solver_;
  Anderson anderson_;
  Predictor predictor_;
};

}  // namespace isosyrk
