// Matrices that are 0 away from the diagonal: finding the band, and what products make of it.
#include <gtest/gtest.h>

#include <cmath>

#include "isosyrk/split/split_blocks.h"
#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/split_products.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Entries falling off by the factor e^-rate from diagonal to diagonal.
Matrix falling_off(Index n, double rate, unsigned seed) {
  Matrix W = random_matrix(n, seed);
  for (Index r = 0; r < n; ++r) {
    for (Index c = 0; c < n; ++c) W(r, c) *= std::exp(-rate * static_cast<double>(std::abs(r - c)));
  }
  return W;
}

// What lies outside a band, in the Frobenius norm.
double outside(const Matrix& W, Index band) {
  double sum = 0.0;
  for (Index r = 0; r < W.rows(); ++r) {
    for (Index c = 0; c < W.cols(); ++c) {
      if (std::abs(r - c) > band) sum += std::norm(W(r, c));
    }
  }
  return std::sqrt(sum);
}

RealVector squares_of(const PlanarMatrix& W) {
  RealVector squares(W.size());
  diagonal_squares(W, squares);
  return squares;
}

RealVector squares_of_skew(const PlanarMatrix& W) {
  RealVector squares(W.size());
  diagonal_squares_of_skew(W, 0, W.size(), squares);
  return squares;
}

TEST(Bands, AreTheSmallestThatLeaveOutNoMoreThanTheTail) {
  for (const Index n : {1, 2, 5, 17, 33, 66}) {
    const Matrix W = falling_off(n, 0.7, static_cast<unsigned>(n));
    const PlanarMatrix skew(Matrix(0.5 * (W - W.adjoint())));
    for (const double tail : {1e-12, 1e-6, 1e-2, 1.0}) {
      const Index band = smallest_band(squares_of(PlanarMatrix(W)), tail);
      EXPECT_LE(outside(W, band), tail) << n;
      if (band > 0) {
        EXPECT_GT(outside(W, band - 1), tail) << n;
      }
      EXPECT_EQ(smallest_band(squares_of_skew(skew), tail), smallest_band(squares_of(skew), tail))
          << n;
    }
    EXPECT_EQ(smallest_band(squares_of(PlanarMatrix(n)), 0.0), 0);
  }
}

TEST(Bands, AreFoundInShares) {
  for (const Index n : {1, 2, 5, 17, 66}) {
    const PlanarMatrix W(random_matrix(n, 1));
    RealVector upper(n), lower(n), part = RealVector::Zero(n);
    diagonal_squares(W, upper, {0, 2});
    diagonal_squares(W, lower, {1, 2});
    const RealVector all = squares_of(W);
    EXPECT_LE((upper + lower - all).norm(), 1e-14 * all.norm()) << n;
    EXPECT_GT((lower - all).norm() + (n == 1 ? 1.0 : 0.0), 0.0) << n;
    const Index middle = n / 3;
    diagonal_squares_of_skew(W, 0, middle, part);
    diagonal_squares_of_skew(W, middle, n, part);
    EXPECT_EQ(part, squares_of_skew(W)) << n;
  }
}

TEST(Bands, HoldWhatIsNotANumber) {
  constexpr Index n = 17;
  Matrix W = falling_off(n, 3.0, 1);
  W(2, 14) = std::nan("");
  EXPECT_GE(smallest_band(squares_of(PlanarMatrix(W)), 1e-3), 12);
  EXPECT_GE(smallest_band(squares_of_skew(PlanarMatrix(W)), 1e-3), 12);
}

TEST(Bands, CutWhatLiesOutsideAndNothingElse) {
  for (const Index n : {1, 5, 17, 33}) {
    const Matrix W = random_matrix(n, 1);
    for (Index band = 0; band <= n + 1; ++band) {
      PlanarMatrix cut(W);
      cut_to_band(band, cut);
      EXPECT_EQ(cut.band(), std::min(band, n - 1));
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          EXPECT_EQ(cut.interleaved()(r, c), std::abs(r - c) > band ? Complex(0.0) : W(r, c));
        }
      }
    }
  }
}

TEST(Bands, OfASkewHermitianMatrixAreMirrored) {
  for (const Index n : {1, 2, 5, 8, 17, 34}) {
    const PlanarMatrix start(random_matrix(n, 1));
    for (Index band = 0; band < n; ++band) {
      PlanarMatrix expected = start, within = start;
      mirror_skew(expected);
      cut_to_band(band, expected);
      mirror_skew_within(band, within);
      EXPECT_EQ(within.entries(), expected.entries()) << n << " " << band;
      EXPECT_EQ(within.band(), band);
    }
  }
}

TEST(Bands, OfAMatrixThatIsLoadedAreTheWhole) {
  PlanarMatrix W(5);
  cut_to_band(1, W);
  W.load(random_matrix(5, 1));
  EXPECT_EQ(W.band(), 4);
}

template <class Real>
PlanarMatrixOf<Real> cut_copy(const Matrix& W, Index band) {
  PlanarMatrixOf<Real> cut(W);
  cut_to_band(band, cut);
  return cut;
}

template <class Real>
PlanarMatrixOf<Real> whole(PlanarMatrixOf<Real> W) {
  W.set_band(W.size() - 1);
  return W;
}

template <class Real>
void expect_bands_change_nothing(const GemmKernel& kernel) {
  for (const Index n : {4, 17, 20, 33, 65, 73, 107, 129}) {
    for (const auto& [A_band, B_band] : {std::pair<Index, Index>{0, 0},
                                         {0, n - 1},
                                         {3, n - 1},
                                         {n - 1, 2},
                                         {4, 7},
                                         {n / 3, n / 2},
                                         {n - 2, 1}}) {
      PlanarProductsOf<Real> products(n, kernel);
      const auto A = cut_copy<Real>(random_matrix(n, 1), A_band);
      const auto B = cut_copy<Real>(random_matrix(n, 2), B_band);
      PlanarMatrixOf<Real> C(n), expected(n);
      products.multiply(A, B, C, Real(0.5));
      products.multiply(whole(A), whole(B), expected, Real(0.5));
      EXPECT_EQ(C.entries(), expected.entries()) << n << " " << A_band << " " << B_band;
      EXPECT_EQ(C.band(), std::min(n - 1, A.band() + B.band()));
      products.multiply_adjoint_left(A, B, C);
      products.multiply_adjoint_left(whole(A), whole(B), expected);
      EXPECT_EQ(C.entries(), expected.entries()) << n << " " << A_band << " " << B_band;

      products.multiply_adjoint_left_upper(A, B, C);
      products.multiply_adjoint_left_upper(whole(A), whole(B), expected);
      const Index wanted = n / 4;
      PlanarMatrixOf<Real> within(n), upper_within(n);
      products.multiply_adjoint_left_within(wanted, A, B, within);
      products.multiply_adjoint_left_upper_within(wanted, A, B, upper_within);
      PlanarMatrixOf<Real> all(n);
      products.multiply_adjoint_left(A, B, all);
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          const Index at = r * C.stride() + c;
          const bool is_within = std::abs(r - c) <= wanted;
          if (is_within) {
            EXPECT_EQ(within.im()[at], all.im()[at]) << n << " " << r << " " << c;
          }
          if (r > c) continue;
          EXPECT_EQ(C.re()[at], expected.re()[at]) << n << " " << r << " " << c;
          if (is_within) {
            EXPECT_EQ(upper_within.im()[at], all.im()[at]);
          }
        }
      }
    }
  }
}

class BandsInEachUnit : public ::testing::TestWithParam<GemmKernel> {};

// What is left out is 0 times something: bit for bit the product of the whole.
TEST_P(BandsInEachUnit, ChangeNoProduct) {
  expect_bands_change_nothing<double>(GetParam());
  expect_bands_change_nothing<float>(GetParam());
}

TEST_P(BandsInEachUnit, ThatAreWrongGiveAWrongProduct) {
  constexpr Index n = 65;
  PlanarProducts products(n, GetParam());
  PlanarMatrix A(random_matrix(n, 1));
  const PlanarMatrix B(random_matrix(n, 2));
  PlanarMatrix expected(n), C(n);
  products.multiply(A, B, expected);
  A.set_band(20);
  products.multiply(A, B, C);
  EXPECT_GT((C.entries() - expected.entries()).norm(), 1.0);
}

// Of an upper triangle or a band the lower half of all entries may take much longer than the upper.
TEST_P(BandsInEachUnit, ShareOutTheMultiplicationsEvenly) {
  constexpr Index n = 129;
  PlanarProducts products(n, GetParam());
  for (const auto& [A_band, B_band] :
       {std::pair<Index, Index>{n - 1, n - 1}, {40, 60}, {n - 1, 20}, {20, n - 1}}) {
    const auto A = cut_copy<double>(random_matrix(n, 1), A_band);
    const auto B = cut_copy<double>(random_matrix(n, 2), B_band);
    for (const bool upper : {false, true}) {
      PlanarMatrix C(n);
      const auto nothing = std::nan("");
      C.entries().setConstant(nothing);
      if (upper) {
        products.multiply_upper(A, B, C, 1.0, {0, 2});
      } else {
        products.multiply(A, B, C, 1.0, {0, 2});
      }
      Index end = 0;  // of the rows that the first share formed
      while (end < n && !std::isnan(C.re()[end * C.stride() + end])) ++end;
      std::array<Index, 2> multiplications{};
      for (Index r = 0; r < n; ++r) {
        for (Index c = upper ? r : 0; c < n; ++c) {
          const Index first = std::max({Index{0}, r - A_band, c - B_band});
          const Index last = std::min({n - 1, r + A_band, c + B_band});
          multiplications[r < end ? 0 : 1] += std::max(Index{0}, last + 1 - first);
        }
      }
      const double above = static_cast<double>(multiplications[0]) /
                           static_cast<double>(multiplications[0] + multiplications[1]);
      // Tiles are formed whole: what of them is not wanted counts too.
      EXPECT_NEAR(above, 0.5, 0.1) << A_band << " " << B_band << " " << upper;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Planar, BandsInEachUnit, ::testing::ValuesIn(tested_kernels()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Bands, CountTheMultiplicationsWithinThem) {
  constexpr Index n = 33;
  PlanarProducts products(n);
  const Matrix W = random_matrix(n, 1);
  PlanarMatrix C(n);
  const auto taken = [&](Index A_band, Index B_band) {
    const std::int64_t before = products.half_multiplications();
    products.multiply(cut_copy<double>(W, A_band), cut_copy<double>(W, B_band), C);
    return (products.half_multiplications() - before) / 2;
  };
  EXPECT_EQ(taken(n - 1, n - 1), n * n * n);
  EXPECT_EQ(taken(0, n - 1), n * n);  // a diagonal times a full matrix
  EXPECT_EQ(taken(0, 0), n);
  EXPECT_EQ(taken(1, 0), 3 * n - 2);
  const double before = products.equivalents();
  products.multiply_upper(PlanarMatrix(W), PlanarMatrix(W), C);
  EXPECT_DOUBLE_EQ(products.equivalents() - before, 0.5);
}

TEST(Bands, OfALaplacianAreTheDiagonalsItSolves) {
  for (const Index n : {5, 17, 33, 50}) {
    const PlanarLaplacian planar{Laplacian(n)};
    const Matrix W = random_skew_hermitian(n, 1);
    PlanarMatrix all(n);
    planar.solve_skew_hermitian(PlanarMatrix(W), 1.0, all);
    for (const Index band : {Index{0}, Index{1}, n / 3, n - 2, n - 1}) {
      Matrix read = W;
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          if (c - r > band || r > c) read(r, c) = std::nan("");  // not to be read
        }
      }
      PlanarMatrix P(random_matrix(n, 2));
      planar.solve_skew_hermitian(PlanarMatrix(read), 1.0, P, band);
      EXPECT_EQ(P.band(), band);
      PlanarMatrix expected = all;
      cut_to_band(band, expected);
      EXPECT_EQ(P.interleaved(), expected.interleaved()) << n << " " << band;
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
