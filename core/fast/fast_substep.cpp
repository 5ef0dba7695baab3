#include "isosyrk/fast/fast_substep.h"

#include <algorithm>
#include <utility>

#include "isosyrk/solver/accepting_residual.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {

SubstepMemory::SubstepMemory(const StageSystem& system, int past_steps)
    : x(system.unknowns()), predictor(past_steps, x), of_system(system.memory()) {}

void SubstepMemory::forget() {
  h.reset();
  iteration.forget();
  predictor.forget();
  choice.forget();
  of_system->forget();
}

void SubstepMemory::archive(StateArchive& state) {
  state.pass(h, iteration, predictor, choice, *of_system);
}

FastSubstep::FastSubstep(std::unique_ptr<StageSystem> system, const FastOptions& options)
    : system_(std::move(system)),
      options_(options.iteration),
      attempts_(system_->attempts(options.newton)),
      past_steps_(options.past_steps.value_or(tuning.past_steps(system_->unknowns()[0][0].size()))),
      offers_both_(offers(Start::predicted) && offers(Start::stepped)),
      newton_(system_->unknowns()),
      picard_(system_->unknowns()),
      anderson_(system_->unknowns()) {
  if (!offers(Start::predicted)) past_steps_ = 0;
  if (offers_both_) trial_ = system_->unknowns();
}

bool FastSubstep::offers(Start how) const {
  return std::ranges::any_of(attempts_,
                             [&](const Attempt& attempt) { return attempt.start == how; });
}

// Tells the choice the error of the start values of the step that has converged, and from time to
// time that of a prediction that was not used.
void FastSubstep::observe_start(Start how, double h, SubstepMemory& memory) {
  StartChoice& choice = memory.choice;
  if (how == Start::predicted) {
    choice.record_past(memory.iteration.start_change);
  } else if (how == Start::stepped) {
    choice.record_explicit(memory.iteration.start_change);
    if (choice.is_trial_due() && memory.predictor.predict(h, trial_)) {
      choice.record_past(largest_difference(trial_, memory.x) / system_->unit(memory.x));
    }
  }
}

bool FastSubstep::starts(Start how, double h, SubstepMemory& memory) {
  if (how == Start::predicted) {
    const bool is_preferred = !offers_both_ || memory.choice.prefers_past();
    return is_preferred && memory.predictor.predict(h, memory.x);
  }
  system_->start(memory.x, how);
  if (how == Start::cold) memory.iteration.forget();
  return true;
}

SolveReport FastSubstep::solve(Iteration iteration, SubstepMemory& memory) {
  switch (iteration) {
    case Iteration::newton:
      return newton_.solve(*system_, memory.iteration, options_, memory.x);
    case Iteration::frozen_picard:
      return picard_.solve_by_far_sweeps(*system_, options_, memory.x);
    case Iteration::anderson:
      return anderson_.solve(*system_, options_, memory.x);
    case Iteration::picard:
    case Iteration::none:
      break;
  }
  return picard_.solve(*system_, options_, memory.x);
}

StepReport FastSubstep::advance(SplitMatrix& W1, const SplitMatrix& W0, double h,
                                SubstepMemory& memory) {
  if (h != memory.h) memory.forget();  // nothing seen before holds
  memory.h = h;
  system_->bind(W0, h, options_.tolerance, *memory.of_system);
  StepReport report;
  for (const Attempt& attempt : attempts_) {
    if (!starts(attempt.start, h, memory)) continue;
    const SolveReport solved = solve(attempt.iteration, memory);
    report.attempt = attempt;
    report.status = solved.status;
    report.sweeps += solved.sweeps;
    report.last_change = solved.change;
    report.contraction = solved.contraction;
    if (report.status == Status::converged) break;
    if (attempt.start == Start::predicted) memory.choice.record_failure_of_past();
  }
  if (report.status == Status::converged) {
    system_->update(W1, memory.x);
    if (offers_both_) observe_start(report.attempt.start, h, memory);
    memory.predictor.accept(h, memory.x);
  }
  return report;
}

double FastSubstep::change_of_one_more_sweep(const SplitMatrix& W0, double h,
                                             const SubstepMemory& of_run, SubstepMemory& beside) {
  beside.forget();
  const bool truncates = system_->truncates();
  system_->truncate(false);
  system_->bind(W0, h, options_.tolerance, *beside.of_system);
  Unknowns accepted = of_run.x;
  Corrections R = corrections_like(accepted);
  const double change = accepting_residual(R, *system_, accepted, options_.tolerance);
  system_->truncate(truncates);
  return change;
}

}  // namespace isosyrk
