// Runs and what their steps alone cost.
#pragma once

#include <functional>

#include "isosyrk/simulation/run.h"

namespace isosyrk {

struct TimedRun {
  RunReport run;
  double seconds = 0.0;  ///< CPU time of the steps, without what `observe` cost
};

/// isosyrk::run with its CPU time; `observe(W)` is called after every completed step.
TimedRun timed_run(Integrator& integrator, MatrixView W, double h, long steps,
                   const std::function<void(const Matrix&)>& observe);

}  // namespace isosyrk
