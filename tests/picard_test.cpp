#include "isosyrk/iteration/picard.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace isosyrk {
namespace {

// The driver on a given sequence of changes; the last one repeats for ever.
SolveReport solve_changes(const std::vector<double>& changes, const SolverOptions& options = {}) {
  std::size_t next = 0;
  return solve_fixed_point(options, [&] { return changes[std::min(next++, changes.size() - 1)]; });
}

TEST(FixedPoint, ConvergesAtTheFirstChangeBelowTolerance) {
  const SolveReport report = solve_changes({1.0, 1e-5, 1e-13, 9e-14, 1e-20});
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.sweeps, 4);  // a change equal to the tolerance is not below it
  EXPECT_EQ(report.change, 9e-14);
}

TEST(FixedPoint, DivergesOnLargeOrNonFiniteChange) {
  for (const double bad : {1.1e6, std::numeric_limits<double>::infinity(), std::nan("")}) {
    const SolveReport report = solve_changes({1.0, bad, 0.0});
    EXPECT_EQ(report.status, Status::diverged);
    EXPECT_EQ(report.sweeps, 2);
  }
  EXPECT_EQ(solve_changes({1e6, 0.0}).status, Status::converged);
}

TEST(FixedPoint, StagnatesAfter50SweepsWithoutABetterChange) {
  const SolveReport report = solve_changes({1.0, 0.5, 0.5});
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_EQ(report.sweeps, 2 + 50);
}

TEST(FixedPoint, IsNotCalledStagnatedWhileItImprovesNowAndThen) {
  double change = 1.0;
  int sweep = 0;
  const SolveReport report = solve_fixed_point({1e-3, 1000}, [&] {
    if (++sweep % 50 == 0) change *= 0.5;
    return change;
  });
  EXPECT_EQ(report.status, Status::converged);
}

TEST(FixedPoint, ReportsTheSweepCapWhileStillFalling) {
  double change = 1.0;
  const SolveReport report = solve_fixed_point({1e-13, 20}, [&] { return change *= 0.9; });
  EXPECT_EQ(report.status, Status::sweep_cap);
  EXPECT_EQ(report.sweeps, 20);
}

TEST(FixedPoint, MeasuresTheContraction) {
  for (const double q : {0.2, 0.9}) {
    double change = 1.0;
    const SolveReport report = solve_fixed_point({}, [&] { return change *= q; });
    EXPECT_NEAR(report.contraction, q, 1e-12);
  }
  // Over the last five sweeps: (1e-14 / 1e-1)^(1/5), of a start that does not count any more.
  EXPECT_NEAR(solve_changes({5.0, 5.0, 1e-1, 1e-3, 1e-4, 1e-6, 1e-9, 1e-14}).contraction,
              std::pow(1e-13, 0.2), 1e-12);
  EXPECT_NEAR(solve_changes({1.0, 1e-14}).contraction, 1e-14, 1e-26);
  EXPECT_EQ(solve_changes({0.0}).contraction, 0.0);  // a single sweep tells nothing
  EXPECT_GT(solve_changes({1.0, 10.0, 1e7}).contraction, 1.0);
}

}  // namespace
}  // namespace isosyrk
