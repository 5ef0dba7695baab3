#include "isosyrk/simulation/run.h"

namespace isosyrk {
namespace {

// Implements run(); calls go_on(totals, report of the step) after every completed step.
template <class GoOn>
RunReport run_steps(Integrator& integrator, MatrixView W, double h, long steps, const GoOn& go_on) {
  // W is the last good state however the run ends, by an exception too.
  struct Ending {
    Integrator& integrator;
    MatrixView& W;
    ~Ending() { integrator.state(W); }
  };

  integrator.set_state(W);
  const Ending ending{integrator, W};
  RunReport total;
  for (long k = 1; k <= steps; ++k) {
    const StepReport step = integrator.step(h);
    total.sweeps += step.sweeps;
    total.work += step.work;
    total.last_change = step.last_change;
    total.contraction = larger(total.contraction, step.contraction);
    if (step.status != Status::converged) {
      total.status = step.status;
      total.failed_step = k;
      return total;
    }
    total.steps = k;
    if (!go_on(total, step)) break;
  }
  return total;
}

}  // namespace

void RunReport::append(const RunReport& later) {
  status = later.status;
  failed_step = later.converged() ? 0 : steps + later.failed_step;
  if (later.steps > 0 || !later.converged()) last_change = later.last_change;
  steps += later.steps;
  contraction = larger(contraction, later.contraction);
  sweeps += later.sweeps;
  work += later.work;
}

void RunReport::archive(StateArchive& state) {
  state.pass(steps, last_change, contraction, sweeps);
  state.pass(work.products, work.equivalent_products, work.poisson_solves, work.projections);
}

RunReport run(Integrator& integrator, MatrixView W, double h, long steps) {
  return run_steps(integrator, W, h, steps,
                   [](const RunReport&, const StepReport&) { return true; });
}

RunReport run_while(Integrator& integrator, MatrixView W, double h, long steps,
                    const std::function<bool(const RunReport&)>& go_on) {
  return run_steps(integrator, W, h, steps,
                   [&](const RunReport& total, const StepReport&) { return go_on(total); });
}

RunReport run(Integrator& integrator, MatrixView W, double h, long steps,
              const std::function<void(long, const Matrix&, const StepReport&)>& observe) {
  Matrix observed = W;
  return run_steps(integrator, W, h, steps, [&](const RunReport& total, const StepReport& step) {
    integrator.state(observed);
    observe(total.steps, observed, step);
    return true;
  });
}

}  // namespace isosyrk
