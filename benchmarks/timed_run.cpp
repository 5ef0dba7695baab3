#include "benchmarks/timed_run.h"

#include "benchmarks/clocks.h"

namespace isosyrk {

TimedRun timed_run(Integrator& integrator, MatrixView W, double h, long steps,
                   const std::function<void(const Matrix&)>& observe) {
  TimedRun result;
  double observing = 0.0;
  const double start = cpu_seconds();
  result.run = run(integrator, W, h, steps, [&](long, const Matrix& V, const StepReport&) {
    const double before = cpu_seconds();
    observe(V);
    observing += cpu_seconds() - before;
  });
  result.seconds = cpu_seconds() - start - observing;
  return result;
}

}  // namespace isosyrk
