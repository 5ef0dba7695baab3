// The fixed-point driver that every implicit integrator shares.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>

#include "isosyrk/linalg/matrix.h"

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
  /// Change of the last sweep over that of the one before, geometric mean over the last five sweeps
  /// (fewer if there were fewer; 0 for a single sweep): below 1 where the iteration contracts.
  double contraction = 0.0;
};

/// The changes of the last few sweeps.
class LastChanges {
 public:
  void add(double change) {
    changes_[count_ % kept] = change;
    ++count_;
  }

  /// As SolveReport::contraction.
  double contraction() const {
    const std::size_t known = std::min(count_, kept);
    if (known < 2) return 0.0;
    const double oldest = changes_[(count_ - known) % kept];
    const double newest = changes_[(count_ - 1) % kept];
    return std::pow(newest / oldest, 1.0 / static_cast<double>(known - 1));
  }

 private:
  static constexpr std::size_t kept = 6;
  std::array<double, kept> changes_{};
  std::size_t count_ = 0;
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
  LastChanges changes;
  double best = std::numeric_limits<double>::infinity();
  int since_best = 0;
  const auto ended = [&](Status status) {
    report.status = status;
    report.contraction = changes.contraction();
    return report;
  };
  while (report.sweeps < options.max_sweeps) {
    report.change = sweep();
    ++report.sweeps;
    changes.add(report.change);
    if (!(report.change <= divergence_bound)) return ended(Status::diverged);  // NaN included
    if (report.change < options.tolerance) return ended(Status::converged);
    if (report.change < best) {
      best = report.change;
      since_best = 0;
    } else if (++since_best >= patience) {
      return ended(Status::stagnated);
    }
  }
  return ended(Status::sweep_cap);
}

}  // namespace isosyrk
