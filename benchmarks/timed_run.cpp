#include "benchmarks/timed_run.h"

#include "benchmarks/clocks.h"

namespace isosyrk {

TimedRun timed_run(Integrator& integrator, MatrixView W, double h, long steps,
                   const std::function<void(const Matrix&)>& observe) {
  TimedRun result;
  Matrix observed = W;
  double observing = 0.0;
  const double start = cpu_seconds();
  result.run = run_while(integrator, W, h, steps, [&](const RunReport&) {
    const double before = cpu_seconds();
    integrator.state(observed);  // to observe it: a frame is left for this alone
    observe(observed);
    observing += cpu_seconds() - before;
    return true;
  });
  result.seconds = cpu_seconds() - start - observing;
  return result;
}

}  // namespace isosyrk
