#include "signals.h"

#include <pybind11/pybind11.h>

#include <chrono>

namespace isosyrk::python {

void handle_signals() {
  using Clock = std::chrono::steady_clock;
  constexpr auto interval = std::chrono::milliseconds(100);
  thread_local Clock::time_point next = Clock::now() + interval;
  const Clock::time_point now = Clock::now();
  if (now < next) return;
  next = now + interval;
  const pybind11::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

}  // namespace isosyrk::python
