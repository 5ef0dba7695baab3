#include "stepper.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <optional>

#include "blas_threads.h"
#include "isosyrk/machine/clocks.h"
#include "isosyrk/scenes/scene.h"
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

namespace {

// Adds the CPU time of its life, which an exception may end.
class TimeAside {
 public:
  explicit TimeAside(double& seconds) : seconds_(seconds) {}
  ~TimeAside() { seconds_ += cpu_seconds() - begin_; }
  TimeAside(const TimeAside&) = delete;
  TimeAside& operator=(const TimeAside&) = delete;

 private:
  double& seconds_;
  double begin_ = cpu_seconds();
};

// Returns whether a function of Python's returns True, and adds the CPU time that it takes.
template <class Argument>
bool says_true(double& seconds, const py::object& function, const Argument& argument) {
  const TimeAside time(seconds);
  const py::gil_scoped_acquire gil;
  return function(argument).is(py::bool_(true));
}

// The state of a run that `between` may change after each step.
class AmendedState {
 public:
  AmendedState(Integrator& integrator, Eigen::Map<Matrix>& view)
      : integrator_(integrator), view_(view), done_(view), next_(view) {}
  // If `between` failed, the view has a part of its changes: it becomes the last state that is
  // done.
  ~AmendedState() { view_ = done_; }
  AmendedState(const AmendedState&) = delete;
  AmendedState& operator=(const AmendedState&) = delete;

  template <class Between>
  void after_step(long step, const Between& between) {
    integrator_.state(view_);
    between();
    next_ = view_;
    require_initial_data(integrator_.flow(), next_, fmt::format("between, step {}", step));
    integrator_.amend_state(next_);
    done_.swap(next_);
  }

 private:
  Integrator& integrator_;
  Eigen::Map<Matrix>& view_;
  Matrix done_;  // after the last step that is done
  Matrix next_;
};

}  // namespace

void Stepper::run(const Array& W, Array state, double h, long steps, const Calls& calls,
                  Outcome& outcome) {
  const InUse in_use(in_use_);
  const Index n = integrator_->flow().size();
  std::memmove(state.mutable_data(), W.data(), W.nbytes());
  Eigen::Map<Matrix> view(state.mutable_data(), n, n);
  const bool amended = !calls.between.is_none();
  const bool observed = !calls.observe.is_none();
  const bool followed = !calls.progress.is_none();
  outcome = {};
  outcome.begun = true;

  const py::gil_scoped_release no_gil;
  const Running running;
  const OneBlasThread one_blas_thread;
  std::optional<AmendedState> amendable;
  if (amended) amendable.emplace(*integrator_, view);
  const double start = cpu_seconds();
  double aside = 0.0;
  const auto seconds = [&] { return cpu_seconds() - start - aside; };
  using Clock = std::chrono::steady_clock;
  constexpr auto interval = std::chrono::milliseconds(100);
  Clock::time_point next_progress = Clock::now() + interval;

  const auto go_on = [&](const RunReport& total) {
    if (amended) {
      amendable->after_step(total.steps, [&] { says_true(aside, calls.between, total.steps); });
    }
    outcome.run = total;
    handle_signals();
    if (followed && Clock::now() >= next_progress) {
      says_true(aside, calls.progress, total.steps);
      next_progress = Clock::now() + interval;
    }
    if (!observed || (total.steps % calls.every != 0 && total.steps != steps)) return true;
    if (!amended) integrator_->state(view);
    outcome.seconds = seconds();
    return !says_true(aside, calls.observe, outcome);
  };
  try {
    outcome.run = run_while(*integrator_, view, h, steps, go_on);
  } catch (...) {
    outcome.seconds = seconds();
    throw;
  }
  outcome.seconds = seconds();
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
