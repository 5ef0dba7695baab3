// Ctrl-C during a step, and the end of the interpreter.
#pragma once

namespace isosyrk::python {

/// To be IterationOptions::after_sweep, and called after every step.  Every tenth of a second it
/// takes the GIL and lets Python handle signals.  Throws pybind11::error_already_set if a handler
/// raises, as Ctrl-C does.  Never returns once the interpreter ends.
void handle_signals();

/// A run without the GIL, from construction to destruction.
class Running {
 public:
  Running();
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
};

/// To be called with the GIL when the interpreter ends.  Runs of daemon threads stop for good where
/// they are: the next time they took the GIL, Python would end their threads by an exception that
/// no destructor may let pass.
void end_runs();

}  // namespace isosyrk::python
