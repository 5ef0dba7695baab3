// The Picard iteration that every implicit integrator shares.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/iteration/status.h"

namespace isosyrk {

/// Remembers the changes of the last six Picard sweeps.
class LastChanges {
 public:
  void add(double change) {
    changes_[count_ % kept] = change;
    ++count_;
  }

  /// Returns SolveReport::contraction.
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

/// Repeats Picard sweeps until one converges or the iteration fails, and returns how it ended.
/// `sweep()` updates every unknown once, all new values from the old ones.  It returns the largest
/// change of an unknown in the Frobenius norm, or NaN if any change is NaN.
/// `accepts(change)` is called after each sweep and says if it was the last one.
/// Source: the paper states only the tolerance.  The other rules are listed in core/README.md,
/// "What the paper leaves open".
template <class Sweep, class Accepts>
SolveReport solve_fixed_point(const IterationOptions& options, Sweep&& sweep, Accepts&& accepts) {
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
    options.swept();
    changes.add(report.change);
    if (!(report.change <= divergence_bound)) return ended(Status::diverged);  // NaN included
    if (accepts(report.change)) return ended(Status::converged);
    if (report.change < best) {
      best = report.change;
      since_best = 0;
    } else if (++since_best >= patience) {
      return ended(Status::stagnated);
    }
  }
  return ended(Status::sweep_cap);
}

/// The same, accepted by the paper's rule: the change of a sweep is below the tolerance.
template <class Sweep>
SolveReport solve_fixed_point(const IterationOptions& options, Sweep&& sweep) {
  return solve_fixed_point(options, sweep,
                           [&](double change) { return change < options.tolerance; });
}

}  // namespace isosyrk
