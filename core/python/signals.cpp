#include "signals.h"

#include <pybind11/pybind11.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <thread>

namespace isosyrk::python {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

std::atomic<bool> ending = false;
std::atomic<int> runs = 0;

}  // namespace

Running::Running() { ++runs; }
Running::~Running() { --runs; }

void end_runs() {
  const pybind11::gil_scoped_release no_gil;  // some may wait for it
  ending = true;
  const Clock::time_point latest = Clock::now() + 2s;
  while (runs > 0 && Clock::now() < latest) std::this_thread::sleep_for(1ms);
}

void handle_signals() {
  constexpr auto interval = 100ms;
  if (ending) {
    --runs;
    for (;;) std::this_thread::sleep_for(1h);
  }
  thread_local Clock::time_point next = Clock::now() + interval;
  const Clock::time_point now = Clock::now();
  if (now < next) return;
  next = now + interval;
  // Handlers compute as Python does, not with denormals flushed as in a fast step.
  std::fenv_t mode;
  std::fegetenv(&mode);
  std::fesetenv(FE_DFL_ENV);
  const pybind11::gil_scoped_acquire gil;
  const bool raised = PyErr_CheckSignals() != 0;
  std::fesetenv(&mode);
  if (raised) throw pybind11::error_already_set();
}

}  // namespace isosyrk::python
