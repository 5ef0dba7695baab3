// Fixed-point iterations: how one ends, by its changes; and its acceleration, which takes fewer
// sweeps to the same fixed point, by real weights.
#include <limits>
#include <vector>

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/anderson.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// The driver on a given sequence of changes; the last one repeats for ever.
SolveReport solve_changes(const std::vector<double>& changes,
                          const IterationOptions& options = {}) {
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

// x = b + i c (D x - x D) with a real diagonal D, for two unknowns: contracts by c |d_r - d_s|,
// with factors on the imaginary axis, as the transport of a skew-Hermitian matrix has.
struct Iteration {
  Index n = 6;
  double c = 0.45;
  Matrix b = random_skew_hermitian(6, 1);
  Unknowns x = {{SplitMatrix(6), SplitMatrix(6)}};

  // Replaces x by G(x); returns the largest change.
  double sweep() {
    const Matrix factors = Matrix::NullaryExpr(n, n, [this](Index r, Index s) {
      return Complex(0.0, c * static_cast<double>(r - s) / static_cast<double>(n - 1));
    });
    double largest = 0.0;
    for (SplitMatrix& each : x[0]) {
      const Matrix before = each.interleaved(), after = b + factors.cwiseProduct(before);
      largest = larger(largest, (after - before).norm());
      each.load(after);
    }
    return largest;
  }

  int sweeps(bool accelerated) {
    Anderson anderson(x);
    anderson.begin(x);
    for (int count = 1; count < 200; ++count) {
      if (sweep() < 1e-13) return count;
      if (accelerated) anderson.mix(x);
    }
    return 200;
  }
};

TEST(Anderson, TakesFewerSweepsToTheSameFixedPoint) {
  Iteration plain, accelerated;
  const int expected = plain.sweeps(false);
  EXPECT_LT(accelerated.sweeps(true), 0.8 * expected);
  for (std::size_t u = 0; u < 2; ++u) {
    EXPECT_LE((plain.x[0][u].entries() - accelerated.x[0][u].entries()).norm(), 1e-12);
  }
}

TEST(Anderson, KeepsWhatIsSkewHermitianExactly) {
  Iteration iteration;
  Anderson anderson(iteration.x);
  anderson.begin(iteration.x);
  for (int k = 0; k < 6; ++k) {
    iteration.sweep();
    anderson.mix(iteration.x);
    for (const SplitMatrix& each : iteration.x[0]) {
      const Matrix W = each.interleaved();
      EXPECT_EQ(W, -W.adjoint()) << k;
    }
  }
}

TEST(Anderson, ConvergesWherePlainIterationDoesNot) {
  Iteration plain, accelerated;
  plain.c = accelerated.c = 1.05;
  EXPECT_EQ(plain.sweeps(false), 200);
  EXPECT_LT(accelerated.sweeps(true), 200);
}

// At a fixed point every difference is 0, and so is its square.
TEST(Anderson, StaysAtAFixedPoint) {
  Unknowns fixed = {{SplitMatrix(3)}};
  Anderson at_rest(fixed);
  at_rest.begin(fixed);
  for (int k = 0; k < 4; ++k) at_rest.mix(fixed);
  EXPECT_EQ(fixed[0][0].interleaved(), Matrix::Zero(3, 3));
}

}  // namespace
}  // namespace isosyrk::testing
