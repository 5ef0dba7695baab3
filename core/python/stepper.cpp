#include "stepper.h"

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

Stepper::Stepper(std::shared_ptr<const Flow> flow, std::unique_ptr<Integrator> integrator)
    : flow_(std::move(flow)), integrator_(std::move(integrator)) {}

Stepper::Outcome Stepper::run(Array W, double h, long steps, const py::object& observe,
                              long every) {
  const InUse in_use(in_use_);
  const Index n = flow_->size();
  Eigen::Map<Matrix> state(W.mutable_data(), n, n);
  const bool observed = !observe.is_none();

  const py::gil_scoped_release no_gil;
  const OneBlasThread one_blas_thread;
  Outcome outcome;
  double observing = 0.0;
  const double start = cpu_seconds();
  outcome.run = run_while(*integrator_, state, h, steps, [&](const RunReport& total) {
    handle_signals();
    if (!observed || (total.steps % every != 0 && total.steps != steps)) return true;
    const double before = cpu_seconds();
    bool go_on = true;
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

std::pair<Stepper::Outcome, std::vector<double>> Stepper::timed_run(const Array& W, double h,
                                                                    long steps, long repetitions,
                                                                    long warmup) {
  const InUse in_use(in_use_);
  const Matrix initial = matrix_of(W);

  const py::gil_scoped_release no_gil;
  const OneBlasThread one_blas_thread;
  const auto go_on = [](const RunReport&) {
    handle_signals();
    return true;
  };
  std::pair<Outcome, std::vector<double>> result;
  auto& [outcome, times] = result;
  Matrix state = initial;
  for (long k = 0; k < repetitions && outcome.run.converged(); ++k) {
    state = initial;
    outcome.run = run_while(*integrator_, state, h, warmup, go_on);
    if (!outcome.run.converged()) break;
    const double start = cpu_seconds();
    outcome.run = run_while(*integrator_, state, h, steps, go_on);
    outcome.seconds = cpu_seconds() - start;
    times.push_back(outcome.seconds);
  }
  return result;
}

}  // namespace isosyrk::python
