#include "isosyrk/simulation/run.h"

namespace isosyrk {

RunReport run(Integrator& integrator, Matrix& W, double h, long steps) {
  return run(integrator, W, h, steps, [](long, const Matrix&, const StepReport&) {});
}

RunReport run(Integrator& integrator, Matrix& W, double h, long steps,
              const std::function<void(long, const Matrix&, const StepReport&)>& observe) {
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
    observe(k, W, step);
  }
  return total;
}

}  // namespace isosyrk
