// The inverse Laplacian on split matrices against the plain one.
#include "isosyrk/flows/split_laplacian.h"

#include <gtest/gtest.h>

#include <cfenv>

#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

template <class Real = double>
Matrix solved(const Laplacian& laplacian, const Matrix& W, double scale) {
  SplitStagesOf<Real> P = split_stages<Real>(1, W.rows());
  SplitLaplacianOf<Real>(laplacian).solve_upper({SplitMatrixOf<Real>(W)}, static_cast<Real>(scale),
                                                W.rows() - 1, P);
  mirror_skew(P);
  return P[0].interleaved();
}

TEST(SplitLaplacian, SolvesAsThePlainOneAndInSinglePrecisionToSomeDigits) {
  std::vector<Index> sizes = {129};
  for (Index n = 2; n <= 80; ++n) sizes.push_back(n);
  for (const Index n : sizes) {
    const Laplacian laplacian(n);
    const Matrix W = random_skew_hermitian(n, static_cast<unsigned>(n));  // its trace is not 0
    Matrix expected(n, n);
    laplacian.solve_skew_hermitian(W, 1.7, expected);
    const Matrix found = solved(laplacian, W, 1.7), single = solved<float>(laplacian, W, 1.7);
    EXPECT_LE(largest_difference(found, expected), 1e-14 * expected.norm()) << n;
    EXPECT_LE(std::abs(found.trace()), 1e-14 * expected.norm()) << n;
    EXPECT_LE((single - found).norm(), 1e-3 * found.norm()) << n;
    EXPECT_GT((single - found).norm(), 1e-9 * found.norm()) << n;  // it is single precision
    for (const Matrix& each : {found, single}) EXPECT_EQ((each + each.adjoint()).norm(), 0.0) << n;
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
