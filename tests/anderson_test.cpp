// Acceleration of a fixed-point iteration: fewer sweeps to the same fixed point, by real weights.
#include "isosyrk/solver/anderson.h"

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

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

TEST(Anderson, TheFirstSweepIsPlainAndSoIsOneThatChangesNothing) {
  Iteration iteration;
  Anderson anderson(iteration.x);
  anderson.begin(iteration.x);
  iteration.sweep();
  const Matrix g = iteration.x[0][0].interleaved();
  anderson.mix(iteration.x);
  // What is added to x is rounded to single precision: x is 0 here.
  EXPECT_LE(largest_difference(iteration.x[0][0].interleaved(), g), 1e-7);
  // At a fixed point every difference is 0, and so is its square.
  Unknowns fixed = {{SplitMatrix(3)}};
  Anderson at_rest(fixed);
  at_rest.begin(fixed);
  for (int k = 0; k < 4; ++k) at_rest.mix(fixed);
  EXPECT_EQ(fixed[0][0].interleaved(), Matrix::Zero(3, 3));
}

}  // namespace
}  // namespace isosyrk::testing
