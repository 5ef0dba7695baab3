// Ctrl-C during a step: Python's signal handlers run between sweeps.
#pragma once

namespace isosyrk::python {

/// To be SolverOptions::after_sweep.  Every tenth of a second it takes the GIL and lets Python
/// handle signals.  Throws pybind11::error_already_set if a handler raises, as Ctrl-C does.
void handle_signals();

}  // namespace isosyrk::python
