// The inverse Laplacian on split matrices against the plain one.
#include "isosyrk/flows/split_laplacian.h"

#include <gtest/gtest.h>

#include <cfenv>

#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

SplitMatrix solved(const SplitLaplacianOf<double>& laplacian, const Matrix& W, double scale) {
  SplitStages P = split_stages(1, W.rows());
  laplacian.solve_upper({SplitMatrix(W)}, scale, W.rows() - 1, P);
  mirror_skew(P);
  return P[0];
}

TEST(SplitLaplacian, SolvesAsThePlainOne) {
  for (Index n = 2; n <= 80; ++n) {
    const Laplacian laplacian(n);
    const Matrix W = random_skew_hermitian(n, static_cast<unsigned>(n));  // its trace is not 0
    Matrix expected(n, n);
    laplacian.solve_skew_hermitian(W, 1.7, expected);
    const Matrix found = solved(SplitLaplacianOf<double>(laplacian), W, 1.7).interleaved();
    EXPECT_LE(largest_difference(found, expected), 1e-14 * expected.norm()) << n;
    EXPECT_EQ((found + found.adjoint()).norm(), 0.0) << n;
    EXPECT_LE(std::abs(found.trace()), 1e-14 * expected.norm()) << n;
  }
}

TEST(SplitLaplacian, ReadsTheUpperTriangleOnly) {
  constexpr Index n = 17;
  const SplitLaplacianOf<double> laplacian{Laplacian(n)};
  Matrix W = random_skew_hermitian(n, 1);
  const Matrix expected = solved(laplacian, W, 1.0).interleaved();
  for (Index r = 0; r < n; ++r) {
    for (Index c = 0; c < r; ++c) W(r, c) = std::nan("");
  }
  EXPECT_EQ(solved(laplacian, W, 1.0).interleaved(), expected);
  W(0, 1) = std::nan("");
  EXPECT_FALSE(solved(laplacian, W, 1.0).interleaved().allFinite());
}

TEST(SplitLaplacian, SolvesEachOfSeveralByItself) {
  constexpr Index n = 17;
  const SplitLaplacianOf<double> laplacian{Laplacian(n)};
  const SplitStages W = {SplitMatrix(random_skew_hermitian(n, 1)),
                         SplitMatrix(random_skew_hermitian(n, 2))};
  SplitStages P = split_stages(2, n);
  laplacian.solve_upper(W, 1.3, n - 1, P);
  for (std::size_t i = 0; i < 2; ++i) {
    SplitStages alone = split_stages(1, n);
    laplacian.solve_upper({W[i]}, 1.3, n - 1, alone);
    EXPECT_EQ(P[i].entries(), alone[0].entries());
  }
  EXPECT_NE(P[0].entries(), P[1].entries());
}

TEST(SplitLaplacian, SolvesTheSameBitForBitWithEveryNumberOfThreads) {
  for (const Index n : {2, 5, 17, 50, 129}) {
    const SplitLaplacianOf<double> laplacian{Laplacian(n)};
    const SplitStages W = {SplitMatrix(random_skew_hermitian(n, 1)),
                           SplitMatrix(random_skew_hermitian(n, 2))};
    for (const Index band : {Index{0}, n / 3, n - 1}) {
      SplitStages whole = split_stages(2, n);
      laplacian.solve_upper(W, 1.3, band, whole);
      for (const int threads : {2, 3, 4, 8}) {
        const ThreadScope scope(threads);
        SplitStages shared = split_stages(2, n);
        laplacian.solve_upper(W, 1.3, band, shared);
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_TRUE(shared[i].entries() == whole[i].entries()) << n << " " << band;
          EXPECT_EQ(shared[i].band(), band);
        }
      }
    }
  }
}

// Which of two threads solved a diagonal shows in its last digits, if the first rounds upwards.
TEST(SplitLaplacian, SharesHoldAboutAsManyEntries) {
#if defined(__clang__)
  GTEST_SKIP() << "LLVM's OpenMP gives each thread the rounding mode of the one that calls";
#endif
  constexpr Index n = 129;
  const SplitLaplacianOf<double> laplacian{Laplacian(n)};
  const SplitStages W = {SplitMatrix(random_skew_hermitian(n, 1))};
  for (const Index band : {Index{20}, n / 2, n - 1}) {
    SplitStages expected = split_stages(1, n), found = expected;
    laplacian.solve_upper(W, 1.3, band, expected);
    {
      const ThreadScope scope(2);
      laplacian.solve_upper(W, 1.3, band, found);  // the second thread is there, and rounds as ever
      ASSERT_TRUE(found[0].entries() == expected[0].entries());
      std::fesetround(FE_UPWARD);
      laplacian.solve_upper(W, 1.3, band, found);
      std::fesetround(FE_TONEAREST);
    }
    const Matrix difference = found[0].interleaved() - expected[0].interleaved();
    Index end = 0;  // of the diagonals that the first thread solved
    while (end <= band && difference.diagonal(end).norm() > 0.0) ++end;
    for (Index m = end; m <= band; ++m) EXPECT_EQ(difference.diagonal(m).norm(), 0.0) << m;
    const auto entries = [](Index from, Index to) {
      return (to - from) * (2 * n - to - from + 1) / 2;
    };
    EXPECT_LE(std::abs(entries(0, end) - entries(end, band + 1)), 16 * n) << band;
  }
}

}  // namespace
}  // namespace isosyrk::testing
