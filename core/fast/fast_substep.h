// One substep of a fast integrator: a stage system, its predictor and solvers with fallbacks.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/past.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/fast/start_choice.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/anderson_iteration.h"
#include "isosyrk/solver/newton.h"
#include "isosyrk/solver/picard_iteration.h"
#include "isosyrk/solver/predictor.h"

namespace isosyrk {

/// Solves the stage equations of a step W₀ -> W₁ in split-complex storage.
///
/// The attempts of the system (StageSystem::attempts) are made in order until one converges.  There
/// is no predicted attempt after a failed step, for another h, or after forget().
///
/// The predictor keeps its past steps where a predicted attempt fails and a cold one works.  In
/// runs of 60 steps of h‖B‖ >= 1.5, where predictions fail (all forms with s <= 3; both scenes at n
/// = 17, in part the smooth one at n = 33), this took 10 % fewer sweeps and 4 % fewer products than
/// forgetting them, in the geometric mean.  Single cells go either way.
class FastSubstep {
 public:
  FastSubstep(std::unique_ptr<StageSystem> system, const FastOptions& options);

  /// Computes W₁ from W₀ by a step of size h.  The report has all but the work.  Past steps, if
  /// used, predict the step, and it joins them: W₀ must then be the W₁ of the call before, or
  /// forget() must be called first.
  StepReport advance(SplitMatrix& W1, const SplitMatrix& W0, double h, Past past);
  /// Forgets all past steps.
  void forget();
  /// Exchanges all that the last step has left to the next, but the past steps of the predictor,
  /// with what was left at the call before.  A lone step (Past::left_out) between two calls
  /// disturbs no run.  Allocates nothing.
  void exchange_memory();

  /// Returns the change of one more Picard sweep, without band truncation, from the unknowns of the
  /// last step, which must have converged from W₀ with this h.  Disturbs no later step.
  double change_of_one_more_sweep(const SplitMatrix& W0, double h);

  const StageSystem& system() const { return *system_; }

 private:
  bool skips(Start how, Past past) const;
  void observe_start(Start how, double h);
  // Sets x_ to the start values of an attempt; false if there are none.
  bool starts(Start how, double h);
  SolveReport solve(Iteration iteration);

  std::unique_ptr<StageSystem> system_;
  IterationOptions options_;
  std::vector<Attempt> attempts_;
  std::optional<double> h_;  // of the last step, if what was seen there may hold in the next
  bool predicts_;            // an attempt starts from past steps
  bool offers_both_;         // and another from an explicit step
  Unknowns x_;
  Newton newton_;
  IterationMemory iteration_;
  PicardIteration picard_;
  AndersonIteration anderson_;
  Predictor predictor_;
  StartChoice choice_;
  Unknowns trial_;  // a prediction of x_, made to see its error
  // x_ and iteration_ of other steps.
  Unknowns other_x_;
  IterationMemory other_iteration_;
};

}  // namespace isosyrk
