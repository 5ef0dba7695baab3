// What is done in single precision, against the same in double.
#include <gtest/gtest.h>

#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"
#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/split_products.h"
#include "isosyrk/linalg/operations.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double single_roundoff = 0x1p-24;

Matrix widened(const SingleMatrix& X) { return X.interleaved(); }

class SinglesInEachUnit : public ::testing::TestWithParam<GemmKernel> {};

TEST_P(SinglesInEachUnit, AreMultipliedToTheirRoundingForEverySize) {
  std::vector<Index> sizes = {47, 63, 64, 65, 97, 104, 105, 107, 128, 129, 140};
  for (Index n = 1; n <= 36; ++n) sizes.push_back(n);
  for (const Index n : sizes) {
    const auto seed = static_cast<unsigned>(n);
    const SingleMatrix A(random_matrix(n, seed)), B(random_matrix(n, seed + 1000));
    const Matrix a = widened(A), b = widened(B);  // what the rounding has left
    const double bound = 4.0 * static_cast<double>(n) * single_roundoff * a.norm() * b.norm();
    SingleProducts products(n, GetParam());
    SingleMatrix C(n);
    products.multiply(A, B, C, -0.5f);
    EXPECT_LE((widened(C) + 0.5 * product({a, b})).norm(), bound) << n;
    products.multiply_adjoint_left(A, B, C);
    EXPECT_LE((widened(C) - product({a.adjoint(), b})).norm(), bound) << n;
    for (Index r = 0; r < n; ++r) {
      for (Index c = n; c < C.stride() / 2; ++c) {
        EXPECT_EQ(C.re()[r * C.stride() + c], 0.0f);
        EXPECT_EQ(C.im()[r * C.stride() + c], 0.0f);
      }
    }
    products.multiply_skew(A, B, C);
    const Matrix skew = widened(C);
    EXPECT_EQ((skew + skew.adjoint()).norm(), 0.0) << n;
    const Matrix wanted = product({a, b});
    for (Index r = 0; r < n; ++r) {
      for (Index c = r + 1; c < n; ++c) EXPECT_LE(std::abs(skew(r, c) - wanted(r, c)), bound);
    }
  }
}

TEST_P(SinglesInEachUnit, SumSharesToTheWhole) {
  for (const Index n : {17, 66, 129}) {
    SingleProducts products(n, GetParam());
    const SingleMatrix A(random_matrix(n, 1)), B(random_matrix(n, 2));
    SingleMatrix C(n), shared(n);
    products.multiply(A, B, C);
    products.multiply(A, B, shared, 1.0f, {0, 2});
    products.multiply(A, B, shared, 1.0f, {1, 2});
    EXPECT_EQ(shared.entries(), C.entries()) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Planar, SinglesInEachUnit, ::testing::ValuesIn(tested_kernels()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Singles, SolveWithTheLaplacianToSomeDigits) {
  for (const Index n : {5, 17, 33, 129}) {
    const Laplacian laplacian(n);
    const PlanarLaplacian planar(laplacian);
    const SingleLaplacian single(laplacian);
    const Matrix W = random_skew_hermitian(n, 1);
    PlanarMatrix expected(n);
    planar.solve_skew_hermitian(PlanarMatrix(W), 1.7, expected);
    SingleMatrix P(n);
    single.solve_skew_hermitian(SingleMatrix(W), 1.7f, P);
    const double error = (widened(P) - expected.interleaved()).norm();
    EXPECT_LE(error, 1e-3 * expected.entries().norm()) << n;
    EXPECT_GT(error, 1e-9 * expected.entries().norm()) << n;  // it is single precision
    EXPECT_EQ((widened(P) + widened(P).adjoint()).norm(), 0.0);
  }
}

TEST(Singles, AreSkewWhereTheirBlocksMakeThemSo) {
  for (const Index n : {3, 17, 34}) {
    const Matrix W = random_matrix(n, 1);
    const SingleMatrix X(W);
    SingleMatrix out(n);
    skew_part(X, 0.5f, out);
    EXPECT_LE((widened(out) - 0.5 * (widened(X) - widened(X).adjoint())).norm(), 1e-4);
    EXPECT_EQ((widened(out) + widened(out).adjoint()).norm(), 0.0);
    minus_adjoint(X, out);
    EXPECT_EQ(widened(out), Matrix(-widened(X).adjoint()));
  }
}

TEST(Singles, HaveASkewPartAboveTheDiagonal) {
  for (const Index n : {1, 2, 5, 8, 17, 34}) {
    const SingleMatrix X(random_matrix(n, 1)), start(random_matrix(n, 2));
    SingleMatrix skew(n);
    skew_part(X, 1.0f, skew);
    for (Index band = 0; band < n; ++band) {
      SingleMatrix out = start;
      upper_skew_part_within(band, X, out);
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          const Index at = r * out.stride() + c;
          const SingleMatrix& expected = c >= r && c - r <= band ? skew : start;
          EXPECT_EQ(out.re()[at], expected.re()[at]) << n << " " << band << " " << r << " " << c;
          EXPECT_EQ(out.im()[at], expected.im()[at]) << n << " " << band << " " << r << " " << c;
        }
      }
    }
  }
}

// In two shares, and in one of two, which leaves something out.
template <class OfShare>
void expect_shares_of_the_whole(const OfShare& form, const SingleMatrix& start) {
  SingleMatrix whole = start, shared = start;
  form(whole, Share{});
  form(shared, Share{0, 2});
  if (start.size() >= 8) {
    EXPECT_NE(shared.entries(), whole.entries()) << start.size();
  }
  form(shared, Share{1, 2});
  EXPECT_EQ(shared.entries(), whole.entries()) << start.size();
}

TEST(Singles, AreMirroredAndTransposedInSharesAsInTheWhole) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34, 129}) {
    const SingleMatrix X(random_matrix(n, 1)), start(random_matrix(n, 2));
    expect_shares_of_the_whole([](SingleMatrix& C, Share share) { mirror_skew(C, share); }, start);
    expect_shares_of_the_whole(
        [&](SingleMatrix& C, Share share) { mirror_skew_within(n / 2, C, share); }, start);
    expect_shares_of_the_whole([&](SingleMatrix& C, Share share) { cut_to_band(1, C, share); },
                               start);
    expect_shares_of_the_whole([&](SingleMatrix& C, Share share) { skew_part(X, 2.0f, C, share); },
                               start);
    expect_shares_of_the_whole(
        [&](SingleMatrix& C, Share share) { upper_skew_part_within(n - 1, X, C, share); }, start);
    expect_shares_of_the_whole([&](SingleMatrix& C, Share share) { minus_adjoint(X, C, share); },
                               start);
    expect_shares_of_the_whole(
        [&](SingleMatrix& C, Share share) { subtract_adjoint(X, 0.3f, C, share); }, start);
  }
}

TEST(Singles, SubtractAnAdjoint) {
  for (const Index n : {1, 2, 5, 8, 17, 34}) {
    const Matrix X = random_matrix(n, 1), start = random_matrix(n, 2);
    SingleMatrix out(start);
    subtract_adjoint(SingleMatrix(X), 0.75f, out);
    EXPECT_LE(largest_difference(widened(out), start - 0.75 * X.adjoint()), 1e-6) << n;
    PlanarMatrix in_double(start);
    subtract_adjoint(PlanarMatrix(X), 0.75, in_double);
    EXPECT_LE(largest_difference(in_double.interleaved(), start - 0.75 * X.adjoint()), 1e-15) << n;
    EXPECT_GT(largest_difference(in_double.interleaved(), start - 0.75 * X.transpose()), 1e-3);
  }
}

TEST(MixedSums, AreThoseOfDoublePrecisionRounded) {
  for (const Index n : {2, 13, 17, 33, 130}) {
    for (const Index s : {1, 2, 3, 4}) {
      const RealMatrix a = RealMatrix::Random(s, s);
      const PlanarMatrix base(random_matrix(n, 1));
      std::vector<PlanarMatrix> Y, X, updated;
      std::vector<SingleMatrix> R;
      for (Index i = 0; i < s; ++i) {
        Y.emplace_back(random_matrix(n, static_cast<unsigned>(10 + i)));
        X.emplace_back(random_matrix(n, static_cast<unsigned>(20 + i)));
        R.emplace_back(n);
      }
      updated = X;
      RealVector expected = RealVector::Zero(s), upper = expected, lower = expected;
      update_unknowns(base, 0.3, a, Y, updated, expected.data());
      residuals(base, 0.3, a, Y, X, R, upper.data(), {0, 2});
      residuals(base, 0.3, a, Y, X, R, lower.data(), {1, 2});
      for (Index i = 0; i < s; ++i) {
        const auto u = static_cast<std::size_t>(i);
        EXPECT_NEAR(upper(i) + lower(i), expected(i), 1e-12 * expected(i)) << n << " " << s;
        const Matrix change = updated[u].interleaved() - X[u].interleaved();
        EXPECT_LE(largest_difference(widened(R[u]), change), 1e-6) << n << " " << s;
        PlanarMatrix sum = X[u];
        add(R[u], sum, {0, 2});
        add(R[u], sum, {1, 2});
        EXPECT_EQ(sum.interleaved(), Matrix(X[u].interleaved() + widened(R[u])));
        SingleMatrix alone(n);
        EXPECT_EQ(residual(base, 0.3, a, i, Y, X[u], alone, {0, 2}), upper(i)) << n << " " << s;
        EXPECT_EQ(residual(base, 0.3, a, i, Y, X[u], alone, {1, 2}), lower(i)) << n << " " << s;
        EXPECT_EQ(alone.entries(), R[u].entries()) << n << " " << s;
        SingleMatrix rounded(n);
        narrow(X[u], rounded, {});
        EXPECT_LE(largest_difference(widened(rounded), X[u].interleaved()), 1e-6);
        EXPECT_NE(widened(rounded), X[u].interleaved());
      }
    }
  }
}

TEST(MixedSums, KeepTheBand) {
  PlanarMatrix X(random_matrix(9, 1));
  cut_to_band(3, X);
  SingleMatrix rounded(9);
  narrow(X, rounded, {1, 2});
  EXPECT_EQ(rounded.band(), 8);
  narrow(X, rounded, {0, 2});
  EXPECT_EQ(rounded.band(), 3);
}

}  // namespace
}  // namespace isosyrk::testing
