// The inverse Laplacian on planar matrices against the plain one.
#include "isosyrk/flows/split_laplacian.h"

#include <gtest/gtest.h>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(PlanarLaplacian, SolvesAsThePlainOne) {
  for (Index n = 2; n <= 80; ++n) {
    const Laplacian laplacian(n);
    const PlanarLaplacian planar(laplacian);
    const Matrix W = random_skew_hermitian(n, static_cast<unsigned>(n));  // its trace is not 0
    Matrix expected(n, n);
    laplacian.solve_skew_hermitian(W, 1.7, expected);
    PlanarMatrix P(n);
    planar.solve_skew_hermitian(PlanarMatrix(W), 1.7, P);
    const Matrix found = P.interleaved();
    EXPECT_LE(largest_difference(found, expected), 1e-14 * expected.norm()) << n;
    EXPECT_EQ((found + found.adjoint()).norm(), 0.0) << n;
    EXPECT_LE(std::abs(found.trace()), 1e-14 * expected.norm()) << n;
  }
}

TEST(PlanarLaplacian, ReadsTheUpperTriangleOnly) {
  constexpr Index n = 17;
  const PlanarLaplacian planar{Laplacian(n)};
  Matrix W = random_skew_hermitian(n, 1);
  PlanarMatrix expected(n), found(n);
  planar.solve_skew_hermitian(PlanarMatrix(W), 1.0, expected);
  for (Index r = 0; r < n; ++r) {
    for (Index c = 0; c < r; ++c) W(r, c) = std::nan("");
  }
  planar.solve_skew_hermitian(PlanarMatrix(W), 1.0, found);
  EXPECT_EQ(found.interleaved(), expected.interleaved());
  W(0, 1) = std::nan("");
  planar.solve_skew_hermitian(PlanarMatrix(W), 1.0, found);
  EXPECT_FALSE(found.interleaved().allFinite());
}

TEST(PlanarLaplacian, SolvesTheDiagonalsOfEachShare) {
  for (const Index n : {2, 5, 17, 50, 129}) {
    const PlanarLaplacian planar{Laplacian(n)};
    const PlanarMatrix W(random_skew_hermitian(n, 1));
    for (const Index band : {Index{0}, n / 3, n - 1}) {
      PlanarMatrix whole(n), shared(n);
      planar.solve_upper(W, 1.3, whole, band);
      planar.solve_upper(W, 1.3, shared, band, {1, 2});
      if (band > 24) {  // a share begins at a multiple of 8
        EXPECT_FALSE(shared.entries() == whole.entries()) << n << " " << band;
      }
      planar.solve_upper(W, 1.3, shared, band, {0, 2});
      EXPECT_TRUE(shared.entries() == whole.entries()) << n << " " << band;
      EXPECT_EQ(shared.band(), band);
    }
  }
}

TEST(PlanarLaplacian, SharesHoldAboutAsManyEntries) {
  constexpr Index n = 129;
  for (const Index band : {Index{20}, n / 2, n - 1}) {
    const Diagonals near(n, band, {0, 2}), far(n, band, {1, 2});
    EXPECT_EQ(near.begin, 0);
    EXPECT_EQ(near.end, far.begin);
    EXPECT_EQ(far.end, band + 1);
    const auto entries = [](const Diagonals& of) {
      return (of.end - of.begin) * (2 * n - of.end - of.begin + 1) / 2;
    };
    EXPECT_LE(std::abs(entries(near) - entries(far)), 16 * n) << band;
  }
}

}  // namespace
}  // namespace isosyrk::testing
