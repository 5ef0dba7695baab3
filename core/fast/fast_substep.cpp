#include "isosyrk/fast/fast_substep.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

FastSubstep::FastSubstep(std::unique_ptr<StageSystem> system, const FastOptions& options)
    : system_(std::move(system)),
      options_(options),
      first_(options.newton ? Iteration::newton : Iteration::picard),
      x_(system_->unknowns()),
      solver_(x_),
      anderson_(x_),
      predictor_(options.past_steps.value_or(tuning.past_steps(x_[0][0].size())), x_) {}

SolveReport FastSubstep::anderson() {
  Corrections& R = solver_.residual();
  anderson_.begin(x_);
  return solve_fixed_point(options_.iteration, [&] {
    const double change = system_->residual(x_, options_.iteration.tolerance, R);
    for (std::size_t kind = 0; kind < x_.size(); ++kind) add(R[kind], x_[kind]);
    if (change >= options_.iteration.tolerance) anderson_.mix(x_);
    return change;
  });
}

SolveReport FastSubstep::solve(Iteration iteration) {
  switch (iteration) {
    case Iteration::newton:
      return solver_.newton(*system_, options_.iteration, x_);
    case Iteration::frozen_picard:
      return solver_.picard(*system_, options_.iteration, tuning.frozen_sweeps, x_);
    case Iteration::anderson:
      return anderson();
    case Iteration::picard:
    case Iteration::none:
      break;
  }
  return solver_.picard(*system_, options_.iteration, 0, x_);
}

bool FastSubstep::converges(Attempt attempt, StepReport& report) {
  const SolveReport solve_report = solve(attempt.iteration);
  report.status = solve_report.status;
  report.attempt = attempt;
  report.sweeps += solve_report.sweeps;
  report.last_change = solve_report.change;
  report.contraction = solve_report.contraction;
  return report.status == Status::converged;
}

void FastSubstep::solve_cold(StepReport& report) {
  solver_.forget();
  for (const Iteration iteration : {first_, Iteration::frozen_picard, Iteration::anderson}) {
    if (iteration == Iteration::frozen_picard && !options_.newton) continue;  // T is part of Newton
    system_->cold_start(x_);
    if (converges({Start::cold, iteration}, report)) break;
  }
}

StepReport FastSubstep::advance(const SplitMatrix& W0, double h, SplitMatrix& W1) {
  system_->bind(W0, h, options_.iteration.tolerance);
  StepReport report;
  const bool predicted = predictor_.predict(h, x_);
  if (!predicted || !converges({Start::predicted, first_}, report)) {
    solve_cold(report);
  }
  if (report.status == Status::converged) {
    system_->update(x_, W1);
    predictor_.accept(h, x_);
  }
  return report;
}

StepReport FastSubstep::advance_alone(const SplitMatrix& W0, double h, SplitMatrix& W1) {
  system_->bind(W0, h, options_.iteration.tolerance);
  StepReport report;
  solve_cold(report);
  if (report.status == Status::converged) system_->update(x_, W1);
  return report;
}

double FastSubstep::change_of_one_more_sweep(const SplitMatrix& W0, double h) {
  const bool truncates = system_->truncates();
  system_->truncate(false);
  system_->bind(W0, h, options_.iteration.tolerance);
  Unknowns accepted = x_;
  const double change =
      system_->residual(accepted, options_.iteration.tolerance, solver_.residual());
  system_->truncate(truncates);
  return change;
}

}  // namespace isosyrk
