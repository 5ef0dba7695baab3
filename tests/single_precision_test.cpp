// Skew-Hermitian parts and mirrors, in both precisions.
#include <gtest/gtest.h>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

template <class Real>
void expect_the_definition(double bound) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34}) {
    const SplitStagesOf<Real> X = {SplitMatrixOf<Real>(random_matrix(n, 1))};
    const Matrix W = X[0].interleaved();
    SplitStagesOf<Real> out = split_stages<Real>(1, n);
    skew_part(X, static_cast<Real>(0.75), out);
    const Matrix found = out[0].interleaved();
    EXPECT_LE(largest_difference(found, 0.75 * (W - W.adjoint())), bound) << n;
    EXPECT_EQ((found + found.adjoint()).norm(), 0.0) << n;
    minus_adjoint(X, out);
    EXPECT_EQ(out[0].interleaved(), Matrix(-W.adjoint())) << n;
    EXPECT_NE(out[0].interleaved(), Matrix(-W.transpose())) << n;
  }
}

TEST(SkewParts, AreThoseOfTheDefinition) {
  expect_the_definition<double>(1e-15);
  expect_the_definition<float>(1e-6);
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

TEST(Singles, AreMirroredAndCutInSharesAsInTheWhole) {
  for (const Index n : {1, 2, 3, 5, 8, 17, 34, 129}) {
    const SingleMatrix start(random_matrix(n, 2));
    expect_shares_of_the_whole([](SingleMatrix& C, Share share) { mirror_skew(C, share); }, start);
    expect_shares_of_the_whole(
        [&](SingleMatrix& C, Share share) { mirror_skew_within(n / 2, C, share); }, start);
    expect_shares_of_the_whole([&](SingleMatrix& C, Share share) { cut_to_band(1, C, share); },
                               start);
  }
}

}  // namespace
}  // namespace isosyrk::testing
