// Runs: many steps of one integrator.
#pragma once

#include <functional>

#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Totals over a run.
struct RunReport {
  Status status = Status::converged;
  long steps = 0;            ///< completed
  long failed_step = 0;      ///< first step that did not converge, counted from 1; 0 if none
  double last_change = 0.0;  ///< of the last step
  double contraction = 0.0;  ///< largest over all steps, a failed one included
  long sweeps = 0;
  Work work = {};

  bool converged() const { return status == Status::converged; }
  double sweeps_per_step() const {
    return steps == 0 ? 0.0 : static_cast<double>(sweeps) / static_cast<double>(steps);
  }

  /// Adds a run that follows, from the state where this one ended: the totals of both in one.
  void append(const RunReport& later);
  /// Passes the totals of a run that converged to an archive, or takes them from it.
  void archive(StateArchive& state);
};

/// Advances W, n x n, by `steps` steps of size h and returns the totals.  Stops at the first step
/// that does not converge; W is then the state before that step.  Allocates nothing.  Throws as
/// Integrator::step.
RunReport run(Integrator& integrator, MatrixView W, double h, long steps);

/// Advances W as above and calls `go_on(totals so far)` after every completed step.  Ends the run
/// where that returns false.  Meanwhile the state is the integrator's, which `go_on` may amend; W
/// is written at the end, by an exception of `go_on` too.
RunReport run_while(Integrator& integrator, MatrixView W, double h, long steps,
                    const std::function<bool(const RunReport&)>& go_on);

/// Advances W as above and calls `observe(step, W, report of the step)` after every completed step.
/// The W observed is a copy, allocated once for the run.
RunReport run(Integrator& integrator, MatrixView W, double h, long steps,
              const std::function<void(long, const Matrix&, const StepReport&)>& observe);

}  // namespace isosyrk
