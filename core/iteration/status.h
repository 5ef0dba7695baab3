// How an iteration ended.
#pragma once

#include <string_view>

namespace isosyrk {

/// How a step ended.
enum class Status {
  converged,
  diverged,  ///< a change was above 1e6 (units as in IterationOptions), or it or W₁ was not finite
  stagnated,  ///< the best change so far was not improved in 50 sweeps
  sweep_cap,  ///< max_sweeps sweeps did not reach the tolerance
};

/// Returns "converged", "diverged", "stagnated" or "sweep cap".
std::string_view name(Status status);

/// How an iteration ended.
struct SolveReport {
  Status status = Status::converged;
  int sweeps = 0;
  double change = 0.0;  ///< largest change of an unknown in the last sweep, as in IterationOptions
  /// Ratio of the changes of two successive sweeps, as the geometric mean of the last five ratios
  /// or of as many as there are.  Below 1 if the iteration contracts; 0 after a single sweep.
  double contraction = 0.0;
};

}  // namespace isosyrk
