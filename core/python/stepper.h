// An integrator as Python uses it.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "arrays.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/simulation/run.h"

namespace isosyrk::python {

/// An integrator.  Calls release the GIL while they step, keep OpenBLAS to one thread
/// meanwhile, and let Python handle signals about ten times a second.  A call while another one is
/// stepping raises RuntimeError.
class Stepper {
 public:
  explicit Stepper(std::unique_ptr<Integrator> integrator) : integrator_(std::move(integrator)) {}

  /// A run and its CPU time in seconds, without what `observe` took.
  struct Outcome {
    RunReport run;
    double seconds = 0.0;
  };

  /// Advances `state`, n x n, from W, which may overlap it.  Unless `observe` is None it is called
  /// with the Outcome so far after every `every` steps, and ends the run by returning True.
  Outcome run(const Array& W, Array state, double h, long steps, const pybind11::object& observe,
              long every);

  /// Returns the CPU seconds of each repetition: from W, `warmup` untimed steps of `state`, then
  /// `steps` timed ones.  After a failure the Outcome says so, with steps counted from W.
  std::pair<Outcome, std::vector<double>> timed_run(const Array& W, Array state, double h,
                                                    long steps, long repetitions, long warmup);

 private:
  class InUse;

  std::unique_ptr<Integrator> integrator_;
  std::atomic<bool> in_use_ = false;
};

}  // namespace isosyrk::python
