// Ctrl-C and SIGTERM during a long run: it ends with what it has, in place of the process with
// nothing.
#pragma once

#include <exception>

namespace isosyrk {

/// Thrown within a step that a signal ends.
class Interrupted : public std::exception {};

/// Makes SIGINT and SIGTERM a flag, so that a run can end in order. One that the process was
/// started to ignore stays ignored. A second signal ends the process at once.
void watch_signals();

/// Returns the number of the signal that came since watch_signals(), or 0.
int caught_signal();

/// Throws Interrupted once a signal came; to be IterationOptions::after_sweep.
void end_if_interrupted();

}  // namespace isosyrk
