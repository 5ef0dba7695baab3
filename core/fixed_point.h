// The fixed-point driver that every implicit integrator shares.
#pragma once

#include <limits>
#include <string_view>

#include "core/matrix.h"

namespace isosyrk {

/// How a step ended.
enum class Status {
  converged,
  diverged,   ///< a change was not finite or above 1e6
  stagnated,  ///< the best change so far was not improved in 50 sweeps
  sweep_cap,  ///< max_sweeps reached while still falling
};

inline std::string_view name(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::diverged:
      return "diverged";
    case Status::stagnated:
      return "stagnated";
    case Status::sweep_cap:
      return "sweep cap";
  }
  return "unknown";
}

struct SolverOptions {
  double tolerance = 1e-13;  ///< absolute, on the largest change of an unknown
  int max_sweeps = 1000;
};

struct SolveReport {
  Status status = Status::converged;
  int sweeps = 0;
  double change = 0.0;  ///< of the last sweep
};

/// Plain fixed-point iteration.  `sweep()` updates every unknown once, Jacobi style (all new values
/// from the old ones), and returns the largest change of an unknown in the Frobenius norm, or NaN
/// if any change is NaN.  The rule is that of README "What the paper leaves open": the paper
/// states only the tolerance.
template <class Sweep>
SolveReport solve_fixed_point(const SolverOptions& options, Sweep&& sweep) {
  constexpr double divergence_bound = 1e6;
  constexpr int patience = 50;

  SolveReport report;
  double best = std::numeric_limits<double>::infinity();
  int since_best = 0;
  while (report.sweeps < options.max_sweeps) {
    report.change = sweep();
    ++report.sweeps;
    if (!(report.change <= divergence_bound)) {  // NaN included
      report.status = Status::diverged;
      return report;
    }
    if (report.change < options.tolerance) {
      report.status = Status::converged;
      return report;
    }
    if (report.change < best) {
      best = report.change;
      since_best = 0;
    } else if (++since_best >= patience) {
      report.status = Status::stagnated;
      return report;
    }
  }
  report.status = Status::sweep_cap;
  return report;
}

}  // namespace isosyrk
