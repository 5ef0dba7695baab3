#include "isosyrk/fast/fast_integrator.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

FastIntegrator::FastIntegrator(const Flow& flow, std::unique_ptr<StageSystem> system,
                               const FastOptions& options)
    : Integrator(flow),
      system_(std::move(system)),
      options_(options),
      W0_(flow.size()),
      W1_(flow.size()),
      x_(system_->unknowns()),
      solver_(x_),
      anderson_(x_),
      predictor_(options.past_steps.value_or(tuning.past_steps(flow.size())), x_) {
  ThreadScope::checked(options.threads);
}

SolveReport FastIntegrator::anderson() {
  Corrections& R = solver_.residual();
  anderson_.begin(x_);
  return solve_fixed_point(options_.solver, [&] {
    const double change = system_->residual(x_, options_.solver.tolerance, R);
    for (std::size_t kind = 0; kind < x_.size(); ++kind) add(R[kind], x_[kind]);
    if (change >= options_.solver.tolerance) anderson_.mix(x_);
    return change;
  });
}

SolveReport FastIntegrator::solve(Iteration iteration) {
  switch (iteration) {
    case Iteration::newton:
      return solver_.newton(*system_, options_.solver, x_);
    case Iteration::frozen_picard:
      return solver_.picard(*system_, options_.solver, tuning.frozen_sweeps, x_);
    case Iteration::anderson:
      return anderson();
    case Iteration::picard:
    case Iteration::none:
      break;
  }
  return solver_.picard(*system_, options_.solver, 0, x_);
}

StepReport FastIntegrator::solve(double h) {
  StepReport report;
  const auto converges = [&](Attempt attempt) {
    const SolveReport solve_report = solve(attempt.iteration);
    report.status = solve_report.status;
    report.attempt = attempt;
    report.sweeps += solve_report.sweeps;
    report.last_change = solve_report.change;
    report.contraction = solve_report.contraction;
    return report.status == Status::converged;
  };
  const Iteration first = options_.newton ? Iteration::newton : Iteration::picard;
  if (predictor_.predict(h, x_)) {
    if (converges({Start::predicted, first})) return report;
    predictor_.forget();
  }
  solver_.forget();
  for (const Iteration iteration : {first, Iteration::frozen_picard, Iteration::anderson}) {
    if (iteration == Iteration::frozen_picard && !options_.newton) continue;  // T is part of Newton
    system_->cold_start(x_);
    if (converges({Start::cold, iteration})) break;
  }
  return report;
}

double FastIntegrator::change_of_one_more_sweep() {
  const ThreadScope scope(options_.threads);
  const bool truncates = system_->truncates();
  system_->truncate(false);
  system_->bind(W0_, h_, options_.solver.tolerance);
  Unknowns accepted = x_;
  const double change = system_->residual(accepted, options_.solver.tolerance, solver_.residual());
  system_->truncate(truncates);
  return change;
}

StepReport FastIntegrator::advance(const Matrix& W0, double h, Matrix& W1) {
  const ThreadScope scope(options_.threads);
  const StepReport before = system_->work();
  W0_.load(W0);
  // Past steps predict only a step that continues from the last W₁.
  if (W0_.entries() != W1_.entries()) predictor_.forget();
  h_ = h;
  system_->bind(W0_, h, options_.solver.tolerance);
  StepReport report;
  try {
    report = solve(h);
  } catch (...) {  // of SolverOptions::after_sweep
    predictor_.forget();
    throw;
  }
  if (report.status == Status::converged) {
    system_->update(x_, W1_);
    predictor_.accept(h, x_);
    W1_.store(W1);
  } else {
    predictor_.forget();
  }
  const StepReport after = system_->work();
  report.products = after.products - before.products;
  report.poisson_solves = after.poisson_solves - before.poisson_solves;
  report.equivalent_products = after.equivalent_products - before.equivalent_products;
  return report;
}

}  // namespace isosyrk
