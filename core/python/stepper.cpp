#include "stepper.h"

#include <cstring>

#include "benchmarks/clocks.h"
#include "blas_threads.h"
#include "signals.h"

namespace isosyrk::python {

namespace py = pybind11;

// Marks a stepper as in use, for the time of one call.
class Stepper::InUse {
 public:
  explicit InUse(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true)) throw std::runtime_error("integrator: is in use by another call");
  }
  ~InUse() { flag_ = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  std::atomic<bool>& flag_;
};

Stepper::Outcome Stepper::run(const Array& W, Array state, double h, long steps,
                              const py::object& observe, long every) {
  const InUse in_use(in_use_);
  const Index n = integrator_->flow().size();
  std::memmove(state.mutable_data(), W.data(), W.nbytes());
  Eigen::Map<Matrix> view(state.mutable_data(), n, n);
  const bool observed = !observe.is_none();

  const py::gil_scoped_release no_gil;
  const Running running;
  const OneBlasThread one_blas_thread;
  Outcome outcome;
  double observing = 0.0;
  const double start = cpu_seconds();
  outcome.run = run_while(*integrator_, view, h, steps, [&](const RunReport& total) {
    handle_signals();
    if (!observed || (total.steps % every != 0 && total.steps != steps)) return true;
    const double before = cpu_seconds();
    bool go_on = true;
    integrator_->state(view);
    {
      const py::gil_scoped_acquire gil;
      go_on = !observe(Outcome{total, before - start - observing}).is(py::bool_(true));
    }
    observing += cpu_seconds() - before;
    return go_on;
  });
  outcome.seconds = cpu_seconds() - start - observing;
  return outcome;
}

std::pair<Stepper::Outcome, std::vector<double>> Stepper::timed_run(const Array& W, Array state,
                                                                    double h, long steps,
                                                                    long repetitions, long warmup) {
  const InUse in_use(in_use_);
  const Index n = integrator_->flow().size();
  Eigen::Map<Matrix> view(state.mutable_data(), n, n);
  const Eigen::Map<const Matrix> initial(W.data(), n, n);

  const py::gil_scoped_release no_gil;
  const Running running;
  const OneBlasThread one_blas_thread;
  const auto go_on = [](const RunReport&) {
    handle_signals();
    return true;
  };
  std::pair<Outcome, std::vector<double>> result;
  auto& [outcome, times] = result;
  for (long k = 0; k < repetitions && outcome.run.converged(); ++k) {
    view = initial;
    outcome.run = run_while(*integrator_, view, h, warmup, go_on);
    if (!outcome.run.converged()) break;
    const double start = cpu_seconds();
    outcome.run = run_while(*integrator_, view, h, steps, go_on);
    outcome.seconds = cpu_seconds() - start;
    outcome.run.steps += warmup;
    if (!outcome.run.converged()) outcome.run.failed_step += warmup;
    times.push_back(outcome.seconds);
  }
  return result;
}

}  // namespace isosyrk::python
