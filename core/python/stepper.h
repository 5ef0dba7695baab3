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

  /// A run, or the steps of it that are done.
  struct Outcome {
    RunReport run;
    double seconds = 0.0;  ///< CPU time without that of the functions called
    bool begun = false;    ///< `state` is the run's
  };

  /// Functions that a run calls, or None.
  struct Calls {
    pybind11::object between;   ///< between(step): may change the state, after every step
    pybind11::object observe;   ///< observe(Outcome so far): True ends the run
    long every;                 ///< steps from one `observe` to the next; the last one is observed
    pybind11::object progress;  ///< progress(step): at most about ten times a second
  };

  /// Advances `state`, n x n, from W, which may overlap it, and reports in `outcome`.  A step is
  /// done once `between` has left a state in the algebra of the flow; another state is refused by
  /// std::invalid_argument.  However the run ends, by an exception too, `state` is that after the
  /// steps of `outcome`.
  void run(const Array& W, Array state, double h, long steps, const Calls& calls, Outcome& outcome);

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
