// Matrices that are 0 away from the diagonal: finding the band, and what products make of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/skew.h"
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

// The band to which the policy cuts W.
template <class Real = double>
Index truncated_band(const Matrix& W, double tail) {
  SplitStagesOf<Real> X = {SplitMatrixOf<Real>(W)};
  BandTruncation(true, 1, W.rows()).truncate(tail, X);
  return X[0].band();
}

SplitMatrix truncated_skew(const Matrix& W, double tail) {
  SplitStages X = {SplitMatrix(W)};
  BandTruncation(true, 1, W.rows()).truncate_skew(tail, X);
  return X[0];
}

TEST(Bands, AreTheSmallestThatLeaveOutNoMoreThanTheTail) {
  for (const Index n : {1, 2, 5, 17, 33, 66}) {
    const Matrix W = falling_off(n, 0.7, static_cast<unsigned>(n));
    const Matrix skew = 0.5 * (W - W.adjoint());
    for (const double tail : {1e-12, 1e-6, 1e-2, 1.0}) {
      const Index band = truncated_band(W, tail);
      EXPECT_LE(outside(W, band), tail) << n;
      if (band > 0) {
        EXPECT_GT(outside(W, band - 1), tail) << n;
      }
      EXPECT_EQ(truncated_skew(skew, tail).band(), truncated_band(skew, tail)) << n;
      EXPECT_EQ(truncated_band<float>(W, 1e-2), truncated_band(W, 1e-2)) << n;
    }
    EXPECT_EQ(truncated_band(Matrix::Zero(n, n), 0.0), 0);
    EXPECT_EQ(smallest_band(RealVector::Zero(n), 0.0), 0);
  }
}

TEST(Bands, AreFoundAndCutByTheTruncationOfEachMatrixByItself) {
  constexpr Index n = 33;
  constexpr double tail = 1e-6;
  const std::array<Matrix, 2> W = {falling_off(n, 0.7, 1), falling_off(n, 3.0, 2)};
  SplitStages X = {SplitMatrix(W[0]), SplitMatrix(W[1])};
  BandTruncation(true, 2, n).truncate(tail, X);
  EXPECT_GT(X[0].band(), X[1].band());
  for (std::size_t i = 0; i < 2; ++i) {
    SplitMatrix expected(W[i]);
    cut_to_band(truncated_band(W[i], tail), expected);
    EXPECT_EQ(X[i].entries(), expected.entries());
    EXPECT_EQ(X[i].band(), expected.band());
    EXPECT_LT(X[i].band(), n - 1);
  }
}

// Of a skew-Hermitian matrix the upper triangle alone is read, and the rest filled in.
TEST(Bands, OfASkewHermitianMatrixAreTakenFromTheUpperTriangle) {
  for (const Index n : {1, 2, 5, 17, 66}) {
    const Matrix W = falling_off(n, 0.7, 1);
    SplitMatrix start(0.5 * (W - W.adjoint()));
    const Matrix skew = start.interleaved();
    for (Index r = 0; r < n; ++r) {
      for (Index c = 0; c < r; ++c) start.re()[r * start.stride() + c] = std::nan("");
    }
    constexpr double tail = 1e-3;
    const SplitMatrix found = truncated_skew(start.interleaved(), tail);
    SplitMatrix expected(skew);
    cut_to_band(truncated_band(skew, tail), expected);
    EXPECT_EQ(found.interleaved(), expected.interleaved()) << n;
  }
}

TEST(Bands, AreTheWholeWhereTruncationIsOff) {
  constexpr Index n = 17;
  const Matrix W = falling_off(n, 3.0, 1);
  BandTruncation truncation(false, 1, n);
  SplitStages X = {SplitMatrix(W)};
  X[0].set_band(3);
  truncation.truncate(1.0, X);
  EXPECT_EQ(X[0].interleaved(), W);
  EXPECT_EQ(X[0].band(), n - 1);
  truncation.truncate_skew(1.0, X);
  EXPECT_EQ(X[0].band(), n - 1);
  SingleStages S = split_stages<float>(1, n);
  truncation.round_skew(1.0, X, S);
  EXPECT_EQ(S[0].band(), n - 1);
  truncation.enable(true);
  truncation.truncate(1.0, X);
  EXPECT_LT(X[0].band(), n - 1);
}

// What is rounded to single precision is cut by another tail, from what truncate_skew measured.
TEST(Bands, OfTheRoundedAreThoseOfALooserTail) {
  constexpr Index n = 33;
  const Matrix W = falling_off(n, 0.7, 1);
  SplitStages B = {SplitMatrix(0.5 * (W - W.adjoint()))};
  const Matrix whole = B[0].interleaved();
  BandTruncation truncation(true, 1, n);
  truncation.truncate_skew(1e-12, B);
  SingleStages S = split_stages<float>(1, n);
  truncation.round_skew(1e-3, B, S);
  EXPECT_EQ(S[0].band(), truncated_band(whole, 1e-3));
  EXPECT_LT(S[0].band(), B[0].band());
  SplitMatrix expected(whole);
  cut_to_band(S[0].band(), expected);
  EXPECT_LE((S[0].interleaved() - expected.interleaved()).norm(), 0x1p-24 * whole.norm());
}

TEST(Bands, HoldWhatIsNotANumber) {
  constexpr Index n = 17;
  Matrix W = falling_off(n, 3.0, 1);
  W(2, 14) = std::nan("");
  EXPECT_GE(truncated_band(W, 1e-3), 12);
  EXPECT_GE(truncated_skew(W, 1e-3).band(), 12);
  W(2, 14) = 0.0;
  EXPECT_LT(truncated_band(W, 1e-3), 12);
}

TEST(Bands, CutWhatLiesOutsideAndNothingElse) {
  for (const Index n : {1, 5, 17, 33}) {
    const Matrix W = random_matrix(n, 1);
    for (Index band = 0; band <= n + 1; ++band) {
      SplitMatrix cut(W);
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
    const SplitMatrix start(random_matrix(n, 1));
    for (Index band = 0; band < n; ++band) {
      SplitMatrix expected = start, within = start;
      mirror_skew(expected);
      cut_to_band(band, expected);
      mirror_skew_within(band, within);
      EXPECT_EQ(within.entries(), expected.entries()) << n << " " << band;
      EXPECT_EQ(within.band(), band);
    }
  }
}

TEST(Bands, OfAMatrixThatIsLoadedAreTheWhole) {
  SplitMatrix W(5);
  cut_to_band(1, W);
  W.load(random_matrix(5, 1));
  EXPECT_EQ(W.band(), 4);
}

template <class Real>
SplitMatrixOf<Real> cut_copy(const Matrix& W, Index band) {
  SplitMatrixOf<Real> cut(W);
  cut_to_band(band, cut);
  return cut;
}

template <class Real>
SplitMatrixOf<Real> whole(SplitMatrixOf<Real> W) {
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
      SplitProductsOf<Real> products(n, kernel);
      const auto A = cut_copy<Real>(random_matrix(n, 1), A_band);
      const auto B = cut_copy<Real>(random_matrix(n, 2), B_band);
      SplitMatrixOf<Real> C(n), expected(n);
      const auto whole_A = whole(A), whole_B = whole(B);
      products.form(times(A, B, C, 0.5));
      products.form(times(whole_A, whole_B, expected, 0.5));
      EXPECT_EQ(C.entries(), expected.entries()) << n << " " << A_band << " " << B_band;
      EXPECT_EQ(C.band(), std::min(n - 1, A.band() + B.band()));
      products.form(adjoint_times(A, B, C));
      products.form(adjoint_times(whole_A, whole_B, expected));
      EXPECT_EQ(C.entries(), expected.entries()) << n << " " << A_band << " " << B_band;

      const Index narrow = n / 4;
      SplitMatrixOf<Real> upper(n), within(n), upper_within(n);
      products.form(adjoint_times(A, B, upper).upper_triangle());
      products.form(adjoint_times(A, B, within).within(narrow));
      products.form(adjoint_times(A, B, upper_within).upper_triangle().within(narrow));
      const auto expect_entry = [&](const SplitMatrixOf<Real>& found, Index r, Index c) {
        const Index at = r * C.stride() + c;
        EXPECT_EQ(found.re()[at], expected.re()[at]) << n << " " << r << " " << c;
        EXPECT_EQ(found.im()[at], expected.im()[at]) << n << " " << r << " " << c;
      };
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          const bool is_within = std::abs(r - c) <= narrow;
          if (is_within) expect_entry(within, r, c);
          if (r <= c) expect_entry(upper, r, c);
          if (is_within && r <= c) expect_entry(upper_within, r, c);
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
  SplitProducts products(n, GetParam());
  SplitMatrix A(random_matrix(n, 1));
  const SplitMatrix B(random_matrix(n, 2));
  SplitMatrix expected(n), C(n);
  products.form(times(A, B, expected));
  A.set_band(20);
  products.form(times(A, B, C));
  EXPECT_GT((C.entries() - expected.entries()).norm(), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Split, BandsInEachUnit, ::testing::ValuesIn(tested_kernels()),
                         ::testing::PrintToStringParamName());

TEST(Bands, CountTheMultiplicationsWithinThem) {
  constexpr Index n = 33;
  SplitProducts products(n);
  const Matrix W = random_matrix(n, 1);
  SplitMatrix C(n);
  const auto taken = [&](Index A_band, Index B_band) {
    const double before = products.equivalents();
    const SplitMatrix A = cut_copy<double>(W, A_band), B = cut_copy<double>(W, B_band);
    products.form(times(A, B, C));
    return std::lround((products.equivalents() - before) * static_cast<double>(n * n * n));
  };
  EXPECT_EQ(taken(n - 1, n - 1), n * n * n);
  EXPECT_EQ(taken(0, n - 1), n * n);  // a diagonal times a full matrix
  EXPECT_EQ(taken(0, 0), n);
  EXPECT_EQ(taken(1, 0), 3 * n - 2);
  const double before = products.equivalents();
  const SplitMatrix full(W);
  products.form(times(full, full, C).upper_triangle());
  EXPECT_DOUBLE_EQ(products.equivalents() - before, 0.5);
}

TEST(Bands, OfALaplacianAreTheDiagonalsItSolves) {
  for (const Index n : {5, 17, 33, 50}) {
    const SplitLaplacianOf<double> laplacian{Laplacian(n)};
    const Matrix W = random_skew_hermitian(n, 1);
    SplitStages all = split_stages(1, n);
    laplacian.solve_upper({SplitMatrix(W)}, 1.0, n - 1, all);
    mirror_skew(all);
    for (const Index band : {Index{0}, Index{1}, n / 3, n - 2, n - 1}) {
      Matrix read = W;
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          if (c - r > band || r > c) read(r, c) = std::nan("");  // not to be read
        }
      }
      const SplitMatrix start(random_matrix(n, 2));
      SplitStages P = {start};
      laplacian.solve_upper({SplitMatrix(read)}, 1.0, band, P);
      EXPECT_EQ(P[0].band(), band);
      for (Index r = 0; r < n; ++r) {  // nothing else is written, but to the end of a block of four
        for (Index c = 0; c < n; ++c) {
          if (c - r > band + 3 || r > c) {
            EXPECT_EQ(P[0].interleaved()(r, c), start.interleaved()(r, c)) << n << " " << band;
          }
        }
      }
      mirror_skew_within(band, P);
      EXPECT_EQ(P[0].band(), band);
      SplitMatrix expected = all[0];
      cut_to_band(band, expected);
      EXPECT_EQ(P[0].interleaved(), expected.interleaved()) << n << " " << band;
      read(0, band) = std::nan("");
      laplacian.solve_upper({SplitMatrix(read)}, 1.0, band, P);
      EXPECT_FALSE(P[0].entries().allFinite()) << n << " " << band;
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
