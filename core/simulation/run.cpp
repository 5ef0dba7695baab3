#include "isosyrk/simulation/run.h"

namespace isosyrk {
namespace {

// Implements run(); calls observe(k, report of step k) after every completed step k.
template <class Observe>
RunReport run_steps(Integrator& integrator, MatrixView W, double h, long steps,
                    const Observe& observe) {
  RunReport total;
  for (long k = 1; k <= steps; ++k) {
    const StepReport step = integrator.step(W, h);
    total.sweeps += step.sweeps;
    total.products += step.products;
    total.poisson_solves += step.poisson_solves;
    total.equivalent_products += step.equivalent_products;
    total.last_change = step.last_change;
    total.contraction = larger(total.contraction, step.contraction);
    if (step.status != Status::converged) {
      total.status = step.status;
      total.failed_step = k;
      return total;
    }
    total.steps = k;
    observe(k, step);
  }
  return total;
}

}  // namespace

RunReport run(Integrator& integrator, MatrixView W, double h, long steps) {
  return run_steps(integrator, W, h, steps, [](long, const StepReport&) {});
}

RunReport run(Integrator& integrator, MatrixView W, double h, long steps,
              const std::function<void(long, const Matrix&, const StepReport&)>& observe) {
  Matrix observed = W;
  return run_steps(integrator, W, h, steps, [&](long k, const StepReport& step) {
    observed = W;
    observe(k, observed, step);
  });
}

}  // namespace isosyrk
