#include "isosyrk/fast/fast_substep.h"

#include <algorithm>
#include <utility>

#include "isosyrk/solver/accepting_residual.h"

namespace isosyrk {
namespace {

bool has(const std::vector<Attempt>& attempts, Start how) {
  return std::ranges::any_of(attempts,
                             [&](const Attempt& attempt) { return attempt.start == how; });
}

}  // namespace

FastSubstep::FastSubstep(std::unique_ptr<StageSystem> system, const FastOptions& options)
    : system_(std::move(system)),
      options_(options.iteration),
      attempts_(system_->attempts(options.newton)),
      predicts_(has(attempts_, Start::predicted)),
      offers_both_(predicts_ && has(attempts_, Start::stepped)),
      x_(system_->unknowns()),
      newton_(x_),
      picard_(x_),
      anderson_(x_),
      predictor_(predicts_ ? options.past_steps.value_or(tuning.past_steps(x_[0][0].size())) : 0,
                 x_),
      other_x_(x_) {
  if (offers_both_) trial_ = x_;
}

// True if an attempt is left out in this step.
bool FastSubstep::skips(Start how, Past past) const {
  if (how != Start::predicted) return false;
  return past == Past::left_out || (offers_both_ && !choice_.prefers_past());
}

// Tells the choice the error of the start values of the step that has converged, and from time to
// time that of a prediction that was not used.
void FastSubstep::observe_start(Start how, double h) {
  if (how == Start::predicted) {
    choice_.saw_past(iteration_.start_change);
  } else if (how == Start::stepped) {
    choice_.saw_explicit(iteration_.start_change);
    if (choice_.is_trial_due() && predictor_.predict(h, trial_)) {
      choice_.saw_past(largest_difference(trial_, x_) / system_->unit(x_));
    }
  }
}

bool FastSubstep::starts(Start how, double h) {
  if (how == Start::predicted) return predictor_.predict(h, x_);
  system_->start(x_, how);
  if (how == Start::cold) iteration_.forget();
  return true;
}

SolveReport FastSubstep::solve(Iteration iteration) {
  switch (iteration) {
    case Iteration::newton:
      return newton_.solve(*system_, iteration_, options_, x_);
    case Iteration::frozen_picard:
      return picard_.solve_by_far_sweeps(*system_, options_, x_);
    case Iteration::anderson:
      return anderson_.solve(*system_, options_, x_);
    case Iteration::picard:
    case Iteration::none:
      break;
  }
  return picard_.solve(*system_, options_, x_);
}

StepReport FastSubstep::advance(SplitMatrix& W1, const SplitMatrix& W0, double h, Past past) {
  if (past == Past::left_out || h != h_) {  // nothing seen before holds
    iteration_.forget();
    system_->forget();
  }
  if (past == Past::used) h_ = h;
  system_->bind(W0, h, options_.tolerance);
  StepReport report;
  for (const Attempt& attempt : attempts_) {
    if (skips(attempt.start, past)) continue;
    if (!starts(attempt.start, h)) continue;
    const SolveReport solved = solve(attempt.iteration);
    report.attempt = attempt;
    report.status = solved.status;
    report.sweeps += solved.sweeps;
    report.last_change = solved.change;
    report.contraction = solved.contraction;
    if (report.status == Status::converged) break;
    if (attempt.start == Start::predicted) choice_.saw_failure_of_past();
  }
  if (report.status == Status::converged) {
    system_->update(W1, x_);
    if (past == Past::used && offers_both_) observe_start(report.attempt.start, h);
    if (past == Past::used && predicts_) predictor_.accept(h, x_);
  }
  return report;
}

void FastSubstep::forget() {
  predictor_.forget();
  choice_.forget();
  h_.reset();
}

void FastSubstep::exchange_memory() {
  x_.swap(other_x_);
  std::swap(iteration_, other_iteration_);
  system_->exchange_memory();
}

double FastSubstep::change_of_one_more_sweep(const SplitMatrix& W0, double h) {
  const Exchanged memory([&] { system_->exchange_memory(); });
  system_->forget();
  const bool truncates = system_->truncates();
  system_->truncate(false);
  system_->bind(W0, h, options_.tolerance);
  Unknowns accepted = x_;
  Corrections R = corrections_like(accepted);
  const double change = accepting_residual(R, *system_, accepted, options_.tolerance);
  system_->truncate(truncates);
  return change;
}

}  // namespace isosyrk
