#include "isosyrk/fast/exponential_system.h"

namespace isosyrk {

ExponentialSystem::ExponentialSystem(const Flow& flow, int order, const FastOptions& options)
    : starts_explicitly_(options.explicit_start),
      operations_(flow, options.bands.value_or(false), options.threads),
      step_(flow.size()),
      equation_(operations_, step_, order, options),
      jacobian_(operations_, step_, equation_.gradient(), order, options),
      update_(operations_, step_),
      explicit_start_(operations_, step_, update_, order) {
  if (options.error_estimates) acceptance_.by = Acceptance::By::error_estimate;
}

std::vector<Attempt> ExponentialSystem::attempts(bool newton) const {
  const Iteration first = newton ? Iteration::newton : Iteration::picard;
  std::vector<Attempt> all = {{Start::predicted, first}};
  if (starts_explicitly_) all.push_back({Start::stepped, first});
  for (const Iteration iteration : {first, Iteration::picard, Iteration::anderson}) {
    all.push_back({Start::cold, iteration});
  }
  return all;
}

std::unique_ptr<StepMemory> ExponentialSystem::memory() const {
  return std::make_unique<ExponentialMemory>(operations_.size());
}

void ExponentialSystem::bind(const SplitMatrix& W0, double h, double tolerance,
                             StepMemory& of_steps) {
  step_.bind(W0, h, tolerance, static_cast<ExponentialMemory&>(of_steps), operations_);
}

void ExponentialSystem::start(Unknowns& x, Start how) {
  const bool is_started = how == Start::stepped && explicit_start_.form(x[0][0]);
  if (!is_started) equation_.start_cold(x[0][0]);
}

ConvergenceTest ExponentialSystem::convergence_test(const Unknowns& x, double tolerance,
                                                    IterationMemory& memory) const {
  return {acceptance_, tolerance, x[0][0].size(), jacobian_.least_contraction(), memory};
}

void ExponentialSystem::update(SplitMatrix& W1, const Unknowns& x) {
  update_.form(W1, x[0][0]);
  explicit_start_.learn(x[0][0]);
}

}  // namespace isosyrk
