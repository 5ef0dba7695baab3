// Bands of split matrices: finding them, and what counts and the Laplacian make of them.
// Skew-Hermitian parts.  Threads share all of this: see fast_forms_test.cpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/linear_combination.h"
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

Matrix skew_falling_off(Index n, double rate, unsigned seed) {
  const Matrix W = falling_off(n, rate, seed);
  return 0.5 * (W - W.adjoint());
}

// W within a band.
Matrix cut(const Matrix& W, Index band) {
  return entries_of(W, [band](Index r, Index c) { return std::abs(r - c) <= band; });
}

// What the policy makes of W, beside a matrix that it cuts more.
template <class Real = double>
SplitMatrixOf<Real> truncated(const Matrix& W, double tail) {
  const Index n = W.rows();
  SplitStagesOf<Real> X = {SplitMatrixOf<Real>(falling_off(n, 9.0, 5)), SplitMatrixOf<Real>(W)};
  BandTruncation(true, 2, n).truncate(X, tail);
  return X[1];
}

SplitMatrix truncated_skew(const Matrix& W, double tail) {
  SplitStages X = {SplitMatrix(W)};
  DiagonalSquares squares = diagonal_squares(1, W.rows());
  BandTruncation(true, 1, W.rows()).truncate_skew(X, squares, tail);
  return X[0];
}

constexpr std::array<double, 5> tails = {1e-12, 1e-6, 1e-3, 1e-2, 1.0};

TEST(Bands, AreTheSmallestThatLeaveOutNoMoreThanTheTail) {
  for (const Index n : {1, 2, 5, 17, 33, 66}) {
    const Matrix W = falling_off(n, 0.7, static_cast<unsigned>(n));
    for (const double tail : tails) {
      const SplitMatrix found = truncated(W, tail);
      const Index band = found.band();
      EXPECT_EQ(found.interleaved(), cut(W, band)) << n;
      EXPECT_LE((W - cut(W, band)).norm(), tail) << n;
      if (band > 0) {
        EXPECT_GT((W - cut(W, band - 1)).norm(), tail) << n;
      }
    }
    EXPECT_EQ(truncated<float>(W, 1e-2).band(), truncated(W, 1e-2).band()) << n;
    EXPECT_EQ(truncated(Matrix::Zero(n, n), 0.0).band(), 0);
  }
}

// Of a skew-Hermitian matrix the upper triangle alone is read, and the rest filled in.
TEST(Bands, OfASkewHermitianMatrixAreTakenFromTheUpperTriangle) {
  for (const Index n : {1, 2, 5, 17, 33, 66}) {
    const Matrix W = skew_falling_off(n, 0.7, 1);
    const Matrix read = entries_of(
        W, [](Index r, Index c) { return r <= c; }, std::nan(""));
    for (const double tail : tails) {
      const SplitMatrix found = truncated_skew(read, tail), expected = truncated(W, tail);
      EXPECT_EQ(found.band(), expected.band()) << n;
      EXPECT_EQ(found.interleaved(), expected.interleaved()) << n;
    }
  }
}

// Of one Hermitian or skew-Hermitian matrix the upper triangle tells the band and the norm.
TEST(Bands, OfOneSymmetricMatrixAreThoseOfAllItsEntries) {
  for (const Index n : {1, 2, 5, 17, 33, 66}) {
    const Matrix skew = skew_falling_off(n, 0.7, 1);
    for (const Matrix& W : {skew, Matrix(Complex(0.0, 1.0) * skew)}) {
      for (const double tail : tails) {
        SplitMatrix found(W);
        BandTruncation bands(true, 1, n);
        RealVector squares = RealVector::Zero(n);
        bands.measure_symmetric(squares, found);
        const SplitMatrix expected = truncated(W, tail);
        EXPECT_EQ(bands.band_of(squares, tail), expected.band()) << n;
        EXPECT_NEAR(bands.measure_and_truncate_symmetric(found, tail), W.norm(), 1e-14 * W.norm())
            << n;
        EXPECT_EQ(found.band(), expected.band()) << n;
        EXPECT_EQ(found.interleaved(), expected.interleaved()) << n;
      }
    }
  }
  // Control: of another matrix the lower triangle is not seen.
  const Matrix lower = entries_of(falling_off(17, 0.7, 1), [](Index r, Index c) { return r >= c; });
  SplitMatrix found(lower);
  BandTruncation(true, 1, 17).truncate_symmetric(found, 1e-6);
  EXPECT_EQ(found.band(), 0);
  EXPECT_GT(truncated(lower, 1e-6).band(), 0);
}

TEST(Bands, ThatAreNotEnabledCutNothing) {
  constexpr Index n = 17;
  const Matrix W = skew_falling_off(n, 2.0, 1);
  SplitMatrix found(W);
  BandTruncation bands(false, 1, n);
  EXPECT_NEAR(bands.measure_and_truncate_symmetric(found, 1.0), W.norm(), 1e-14 * W.norm());
  EXPECT_EQ(found.interleaved(), W);
  EXPECT_EQ(bands.band_of(RealVector::Zero(n), 1.0), n - 1);
}

// A band that becomes narrower clears what it leaves, and nothing else; one that becomes wider
// finds zeros there.
TEST(Bands, ThatChangeLeaveZerosOutside) {
  for (const Index n : {1, 5, 17, 66}) {
    const Matrix W = falling_off(n, 0.1, 3);
    SplitMatrix X(W);
    for (const Index band : {n / 2, n / 3, Index{0}}) {
      change_band(X, band);
      EXPECT_EQ(X.band(), std::min(band, n - 1)) << n;
      EXPECT_EQ(X.interleaved(), cut(W, band)) << n;
    }
    change_band(X, n - 1);
    EXPECT_EQ(X.band(), n - 1) << n;
    EXPECT_EQ(X.interleaved(), cut(W, 0)) << n;
  }
}

// Returns W cut to a band, as a split matrix that knows its band.
SplitMatrix banded(const Matrix& W, Index band) {
  SplitMatrix X(cut(W, band));
  X.set_band(band);
  return X;
}

// Sums, roundings and norms of single matrices pass over bands, and give what full matrices do: the
// result may have been wider or narrower before.
TEST(Bands, OfSumsRoundingsAndNormsChangeNothing) {
  for (const Index n : {5, 17, 40, 66}) {
    const Matrix A = falling_off(n, 0.1, 1), B = falling_off(n, 0.1, 2), C = falling_off(n, 0.1, 3);
    for (const Index before : {Index{1}, n / 3, n - 1}) {
      const SplitMatrix first = banded(A, n / 2), second = banded(B, n / 4);
      const SplitMatrix full_first(cut(A, n / 2)), full_second(cut(B, n / 4));

      SplitMatrix sum = banded(C, before), expected(C);
      sum = 0.3 * first - 2.0 * second;
      expected = 0.3 * full_first - 2.0 * full_second;
      EXPECT_EQ(sum.interleaved(), expected.interleaved()) << n;
      EXPECT_EQ(sum.band(), n / 2) << n;
      EXPECT_NEAR(norm(sum), expected.interleaved().norm(), 1e-14 * norm(expected)) << n;

      SingleMatrix rounded(n);
      round_to_single(rounded, banded(C, before));
      round_to_single(rounded, second);
      EXPECT_EQ(rounded.band(), n / 4) << n;
      EXPECT_EQ(rounded.interleaved(), SingleMatrix(cut(B, n / 4)).interleaved()) << n;

      SplitMatrix wide = banded(C, before);
      widen(wide, rounded);
      EXPECT_EQ(wide.band(), n / 4) << n;
      EXPECT_EQ(wide.interleaved(), rounded.interleaved()) << n;
      add(wide, rounded, 0.5);
      EXPECT_LE((wide.interleaved() - 1.5 * rounded.interleaved()).norm(), 1e-14) << n;

      SingleStages R = {SingleMatrix(C)};
      form_residual(
          R, [&](std::size_t) { return 1.0 * first; }, SplitStages{second});
      EXPECT_EQ(R[0].band(), n / 2) << n;
      EXPECT_LE((R[0].interleaved() - cut(A, n / 2) + cut(B, n / 4)).norm(), 1e-6 * A.norm()) << n;
    }
  }
  // Control: an entry outside the band that a matrix claims is lost.
  const Matrix A = falling_off(17, 0.1, 1);
  SplitMatrix wrong(A), sum(17);
  wrong.set_band(2);
  sum.set_band(0);
  sum = 1.0 * wrong;
  EXPECT_NE(sum.interleaved(), A);
}

// One matrix is mirrored and made skew within its band, and what was in the lower triangle goes.
TEST(Bands, OfMirrorsAndSkewPartsChangeNothing) {
  for (const Index n : {1, 5, 17, 66}) {
    const Index band = n / 3;
    const Matrix W = skew_falling_off(n, 0.1, 1), stale = falling_off(n, 0.1, 2);
    const Matrix upper = entries_of(cut(W, band), [](Index r, Index c) { return r <= c; });
    const Matrix below = entries_of(stale, [](Index r, Index c) { return r > c; });

    SplitMatrix skew(Matrix(upper + below));
    skew.set_band(band);
    mirror_all_skew(skew);
    EXPECT_EQ(skew.interleaved(), cut(W, band)) << n;

    SplitMatrix within(Matrix(upper + cut(below, band)));
    within.set_band(band);
    mirror_skew_in_band(within);
    EXPECT_EQ(within.interleaved(), cut(W, band)) << n;

    SplitMatrix hermitian(Matrix(Complex(0.0, 1.0) * upper + below));
    hermitian.set_band(band);
    mirror_all_hermitian(hermitian);
    EXPECT_EQ(hermitian.interleaved(), Complex(0.0, 1.0) * cut(W, band)) << n;

    SplitMatrix part(stale);
    skew_part(part, banded(W, band), 0.5);
    EXPECT_EQ(part.band(), band) << n;
    EXPECT_EQ(part.interleaved(), cut(W, band)) << n;
  }
}

// What is rounded to single precision is cut by another tail, from what truncate_skew measured.
TEST(Bands, OfTheRoundedAreThoseOfALooserTail) {
  constexpr Index n = 33;
  const Matrix W = skew_falling_off(n, 0.7, 1);
  SplitStages B = {SplitMatrix(W)};
  const BandTruncation truncation(true, 1, n);
  DiagonalSquares squares = diagonal_squares(1, n);
  truncation.truncate_skew(B, squares, 1e-12);
  SingleStages S = split_stages<float>(1, n);
  truncation.round_skew(S, B, squares, 1e-3);
  EXPECT_EQ(S[0].band(), truncated(W, 1e-3).band());
  EXPECT_LT(S[0].band(), B[0].band());
  EXPECT_LE((S[0].interleaved() - cut(W, S[0].band())).norm(), 0x1p-24 * W.norm());
}

TEST(Bands, HoldWhatIsNotANumber) {
  Matrix W = falling_off(17, 3.0, 1);
  EXPECT_LT(truncated(W, 1e-3).band(), 12);
  W(2, 14) = std::nan("");
  EXPECT_GE(truncated(W, 1e-3).band(), 12);
  EXPECT_GE(truncated_skew(W, 1e-3).band(), 12);
}

TEST(Bands, CountTheMultiplicationsWithinThem) {
  constexpr Index n = 33;
  SplitProducts products(n);
  SplitMatrix C(n);
  const auto taken = [&](Index A_band, Index B_band) {
    const double before = products.equivalents();
    SplitMatrix A(random_matrix(n, 1)), B = A;
    cut_to_band(A, A_band);
    cut_to_band(B, B_band);
    products.form(into(C, A * B));
    return std::lround((products.equivalents() - before) * static_cast<double>(n * n * n));
  };
  EXPECT_EQ(taken(n - 1, n - 1), n * n * n);
  EXPECT_EQ(taken(0, n - 1), n * n);  // a diagonal times a full matrix
  EXPECT_EQ(taken(0, 0), n);
  EXPECT_EQ(taken(1, 0), 3 * n - 2);
}

TEST(Bands, OfALaplacianAreTheDiagonalsItSolves) {
  for (const Index n : {5, 17, 33, 50}) {
    const SplitLaplacianOf<double> laplacian{Laplacian(n)};
    const Matrix W = random_skew_hermitian(n, 1);
    SplitStages all = split_stages(1, n);
    laplacian.solve_upper(SplitStages{SplitMatrix(W)}, 1.0, n - 1, all);
    mirror_skew(all);
    for (const Index band : {Index{0}, Index{1}, n / 3, n - 2, n - 1}) {
      SCOPED_TRACE(::testing::Message() << "n = " << n << ", band " << band);
      const auto is_read = [band](Index r, Index c) { return r <= c && c - r <= band; };
      Matrix read = entries_of(W, is_read, std::nan(""));
      const SplitMatrix start(random_matrix(n, 2));
      SplitStages P = {start};
      laplacian.solve_upper(SplitStages{SplitMatrix(read)}, 1.0, band, P);
      EXPECT_EQ(P[0].band(), band);
      // Nothing else is written, but to the end of a block of four.
      const auto is_kept = [band](Index r, Index c) { return r > c || c - r > band + 3; };
      EXPECT_EQ(entries_of(P[0].interleaved(), is_kept), entries_of(start.interleaved(), is_kept));
      mirror_skew_within(P, band);
      EXPECT_EQ(P[0].interleaved(), cut(all[0].interleaved(), band));
      read(0, band) = std::nan("");
      laplacian.solve_upper(SplitStages{SplitMatrix(read)}, 1.0, band, P);
      EXPECT_FALSE(P[0].entries().allFinite());
    }
  }
}

template <class Real>
void expect_skew_parts_of_the_definition(double bound) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34}) {
    const SplitStagesOf<Real> X = {SplitMatrixOf<Real>(random_matrix(n, 1))};
    const Matrix W = X[0].interleaved();
    SplitStagesOf<Real> out = split_stages<Real>(1, n);
    skew_part(out, X, 0.75);
    EXPECT_LE(largest_difference(out[0].interleaved(), 0.75 * (W - W.adjoint())), bound) << n;
    EXPECT_EQ(skew_defect(out[0].interleaved()), 0.0) << n;
    minus_adjoint(out, X);
    EXPECT_EQ(out[0].interleaved(), Matrix(-W.adjoint())) << n;
  }
}

TEST(SkewParts, AreThoseOfTheDefinition) {
  expect_skew_parts_of_the_definition<double>(1e-15);
  expect_skew_parts_of_the_definition<float>(1e-6);
}

}  // namespace
}  // namespace isosyrk::testing
