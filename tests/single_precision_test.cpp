// What is done in single precision, against the same in double.
#include <gtest/gtest.h>

#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/skew.h"
#include "isosyrk/split/split_products.h"
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
    products.form(times(A, B, C, -0.5f));
    EXPECT_LE((widened(C) + 0.5 * product({a, b})).norm(), bound) << n;
    products.form(adjoint_times(A, B, C));
    EXPECT_LE((widened(C) - product({a.adjoint(), b})).norm(), bound) << n;
    for (Index r = 0; r < n; ++r) {
      for (Index c = n; c < C.stride() / 2; ++c) {
        EXPECT_EQ(C.re()[r * C.stride() + c], 0.0f);
        EXPECT_EQ(C.im()[r * C.stride() + c], 0.0f);
      }
    }
    products.form(times(A, B, C).upper_triangle());
    mirror_skew(C);
    const Matrix skew = widened(C);
    EXPECT_EQ((skew + skew.adjoint()).norm(), 0.0) << n;
    const Matrix wanted = product({a, b});
    for (Index r = 0; r < n; ++r) {
      for (Index c = r + 1; c < n; ++c) EXPECT_LE(std::abs(skew(r, c) - wanted(r, c)), bound);
    }
  }
}

// In two shares, one of which leaves something out; and as the threads form it.
TEST_P(SinglesInEachUnit, SumSharesToTheWhole) {
  for (const Index n : {17, 66, 129}) {
    SingleProducts products(n, GetParam(), 8);
    const SingleMatrix A(random_matrix(n, 1)), B(random_matrix(n, 2));
    SingleMatrix C(n), shared(n);
    products.form(times(A, B, C));
    multiply_share(GetParam(), A, B, shared, false, {0, 1, 2});
    EXPECT_NE(shared.entries(), C.entries()) << n;
    multiply_share(GetParam(), A, B, shared, false, {1, 2, 2});
    EXPECT_EQ(shared.entries(), C.entries()) << n;
    for (const int threads : {2, 3, 4, 8}) {
      const ThreadScope scope(threads);
      SingleMatrix by_threads(n);
      products.form(times(A, B, by_threads));
      EXPECT_EQ(by_threads.entries(), C.entries()) << n << " " << threads;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Split, SinglesInEachUnit, ::testing::ValuesIn(tested_kernels()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Singles, SolveWithTheLaplacianToSomeDigits) {
  for (const Index n : {5, 17, 33, 129}) {
    const Laplacian laplacian(n);
    const Matrix W = random_skew_hermitian(n, 1);
    SplitStages expected = split_stages(1, n);
    SplitLaplacianOf<double>(laplacian).solve_upper({SplitMatrix(W)}, 1.7, n - 1, expected);
    mirror_skew(expected);
    SingleStages P = split_stages<float>(1, n);
    SplitLaplacianOf<float>(laplacian).solve_upper({SingleMatrix(W)}, 1.7f, n - 1, P);
    mirror_skew(P);
    const double error = (widened(P[0]) - expected[0].interleaved()).norm();
    EXPECT_LE(error, 1e-3 * expected[0].entries().norm()) << n;
    EXPECT_GT(error, 1e-9 * expected[0].entries().norm()) << n;  // it is single precision
    EXPECT_EQ((widened(P[0]) + widened(P[0]).adjoint()).norm(), 0.0);
  }
}

TEST(Singles, AreSkewWhereTheirBlocksMakeThemSo) {
  for (const Index n : {3, 17, 34}) {
    const SingleStages X = {SingleMatrix(random_matrix(n, 1))};
    const Matrix wide = widened(X[0]);
    SingleStages out = split_stages<float>(1, n);
    skew_part(X, 0.5f, out);
    EXPECT_LE((widened(out[0]) - 0.5 * (wide - wide.adjoint())).norm(), 1e-4);
    EXPECT_EQ((widened(out[0]) + widened(out[0]).adjoint()).norm(), 0.0);
    minus_adjoint(X, out);
    EXPECT_EQ(widened(out[0]), Matrix(-wide.adjoint()));
  }
}

TEST(SkewParts, AreThoseOfTheDefinitionInDoublePrecision) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34}) {
    const Matrix W = random_matrix(n, 1);
    const SplitStages X = {SplitMatrix(W)};
    SplitStages out = split_stages(1, n);
    skew_part(X, 0.75, out);
    const Matrix found = out[0].interleaved();
    EXPECT_LE(largest_difference(found, 0.75 * (W - W.adjoint())), 1e-15) << n;
    EXPECT_EQ((found + found.adjoint()).norm(), 0.0) << n;
    minus_adjoint(X, out);
    EXPECT_EQ(out[0].interleaved(), Matrix(-W.adjoint())) << n;
    EXPECT_NE(out[0].interleaved(), Matrix(-W.transpose())) << n;
  }
}

TEST(Singles, HaveASkewPartAboveTheDiagonal) {
  for (const Index n : {1, 2, 5, 8, 17, 34}) {
    const SingleStages X = {SingleMatrix(random_matrix(n, 1))};
    const SingleMatrix start(random_matrix(n, 2));
    SingleStages skew = split_stages<float>(1, n);
    skew_part(X, 1.0f, skew);
    for (Index band = 0; band < n; ++band) {
      SingleStages out = {start};
      upper_skew_part_within(band, X, out);
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          const Index at = r * start.stride() + c;
          const SingleMatrix& expected = c >= r && c - r <= band ? skew[0] : start;
          EXPECT_EQ(out[0].re()[at], expected.re()[at]) << n << " " << band << " " << r << " " << c;
          EXPECT_EQ(out[0].im()[at], expected.im()[at]) << n << " " << band << " " << r << " " << c;
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
  form(shared, Share{0, 1, 2});
  if (start.size() >= 8) {
    EXPECT_NE(shared.entries(), whole.entries()) << start.size();
  }
  form(shared, Share{1, 2, 2});
  EXPECT_EQ(shared.entries(), whole.entries()) << start.size();
}

// Of two matrices, by any number of threads.
template <class OfStages>
void expect_the_same_of_all_threads(const OfStages& form, const SingleMatrix& start) {
  const SingleStages begin = {start, start};
  SingleStages whole = begin;
  form(whole);
  for (const int threads : {2, 3, 4, 8}) {
    const ThreadScope scope(threads);
    SingleStages shared = begin;
    form(shared);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(shared[i].entries(), whole[i].entries()) << start.size() << " " << threads;
      EXPECT_EQ(shared[i].band(), whole[i].band());
    }
  }
}

TEST(Singles, AreMirroredAndTransposedInSharesAsInTheWhole) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34, 129}) {
    const SingleMatrix start(random_matrix(n, 2));
    const SingleStages X = {SingleMatrix(random_matrix(n, 1)), SingleMatrix(random_matrix(n, 3))};
    expect_shares_of_the_whole([](SingleMatrix& C, Share share) { mirror_skew(C, share); }, start);
    expect_shares_of_the_whole(
        [&](SingleMatrix& C, Share share) { mirror_skew_within(n / 2, C, share); }, start);
    expect_shares_of_the_whole([&](SingleMatrix& C, Share share) { cut_to_band(1, C, share); },
                               start);
    expect_the_same_of_all_threads([](SingleStages& C) { mirror_skew(C); }, start);
    expect_the_same_of_all_threads([&](SingleStages& C) { mirror_skew_within(n / 2, C); }, start);
    expect_the_same_of_all_threads([&](SingleStages& C) { skew_part(X, 2.0f, C); }, start);
    expect_the_same_of_all_threads([&](SingleStages& C) { upper_skew_part_within(n - 1, X, C); },
                                   start);
    expect_the_same_of_all_threads([&](SingleStages& C) { minus_adjoint(X, C); }, start);
  }
}

}  // namespace
}  // namespace isosyrk::testing
