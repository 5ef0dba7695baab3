// Linear combinations of split matrices in one pass, against the same sums one term at a time.
#include "isosyrk/split/linear_combination.h"

#include <limits>

#include "isosyrk/split/bands.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Sizes with every rest of the vectors, on both sides of where rows are padded more and where sums
// are cut into blocks.
const std::vector<Index> sizes = {1, 2, 5, 8, 13, 17, 33, 34, 47, 48, 61, 66, 130};

const std::vector<std::size_t> counts = {1, 2, 3, 4, 5, 6, 7, 8, 25};

// Entries are multiples of 2⁻⁴ up to 1 in single precision and of 2⁻³⁰ in double, weights multiples
// of 1/8 up to 6: sums are exact in their own precision.
double weight_of(std::size_t t) { return 0.25 * static_cast<double>(t) - 0.875; }

template <class Real>
SplitStagesOf<Real> random_stages(std::size_t count, Index n, unsigned seed) {
  constexpr double unit = sizeof(Real) == sizeof(float) ? 0x1p-4 : 0x1p-30;
  const auto rounded = [](double number) { return unit * std::round(number / unit); };
  SplitStagesOf<Real> X;
  for (std::size_t t = 0; t < count; ++t) {
    const Matrix random = random_matrix(n, seed + static_cast<unsigned>(t));
    X.emplace_back(Matrix(random.unaryExpr(
        [&](const Complex& z) { return Complex(rounded(z.real()), rounded(z.imag())); })));
  }
  return X;
}

template <class Real>
LinearCombination<Real> weighted(const SplitStagesOf<Real>& X) {
  static const RealVector weights =
      RealVector::NullaryExpr(static_cast<Index>(LinearCombination<Real>::most),
                              [](Index t) { return weight_of(static_cast<std::size_t>(t)); });
  return sum(weights, X);
}

template <class Real>
void expect_sums() {
  for (const Index n : sizes) {
    for (const std::size_t count : counts) {
      SCOPED_TRACE(::testing::Message() << n << " " << count);
      const auto X = random_stages<Real>(count, n, 1);
      Matrix expected = Matrix::Zero(n, n);
      for (std::size_t t = 0; t < count; ++t) expected += weight_of(t) * X[t].interleaved();
      SplitMatrixOf<Real> found_sum(n);
      found_sum = weighted(X);
      EXPECT_EQ(found_sum.interleaved(), expected);
      EXPECT_TRUE(fill_is_zero(found_sum));

      auto replaced = random_stages<Real>(2, n, 100);
      const double change = std::max((replaced[0].interleaved() - expected).norm(),
                                     (replaced[1].interleaved() - expected).norm());
      const double found = replace(replaced, [&](std::size_t) { return weighted(X); });
      // The sum of 2 n² squares, in parts of some hundred each, errs by a few roundoffs relatively.
      EXPECT_NEAR(found, change, 64.0 * std::numeric_limits<Real>::epsilon() * change);
      for (const auto& each : replaced) EXPECT_EQ(each.entries(), found_sum.entries());
    }
  }
}

TEST(LinearCombinations, OfAnyNumberOfTermsAreTheirSum) {
  expect_sums<double>();
  expect_sums<float>();
}

template <class Real>
void expect_alike_whatever_the_band() {
  for (const Index n : sizes) {
    const Index band = n / 4;
    for (const std::size_t count : counts) {
      SCOPED_TRACE(::testing::Message() << n << " " << count);
      SplitStagesOf<Real> X;
      for (std::size_t t = 0; t < count; ++t) {
        X.emplace_back(random_matrix(n, static_cast<unsigned>(t) + 1));
        cut_to_band(X.back(), band, {});
      }
      const RealVector weights = RealVector::NullaryExpr(
          static_cast<Index>(count), [](Index t) { return 1.0 / static_cast<double>(t + 3); });
      SplitMatrixOf<Real> of_full(n), of_band(n);
      of_full = sum(weights, X);
      of_band.set_band(band);
      of_band = sum(weights, X);
      EXPECT_EQ(of_full.interleaved(), of_band.interleaved());
    }
  }
}

// What a matrix held before does not show in the sum that it takes, not even in its rounding.
TEST(LinearCombinations, RoundAlikeInMatricesOfAnyFormerBand) {
  expect_alike_whatever_the_band<double>();
  expect_alike_whatever_the_band<float>();
}

// Formed in double, then rounded: half a unit of the last digit of a float.  Close to the solution
// the leading digits cancel, and rounding first would leave 1e-1 of R.
TEST(Residuals, AreTheChangesOfDoublePrecisionRounded) {
  for (const Index n : sizes) {
    for (const std::size_t count : counts) {
      for (const double distance : {1.0, 1e-6}) {
        const auto terms = random_stages<double>(count, n, 1);
        const auto sum = [&](std::size_t) { return weighted(terms); };
        auto X = random_stages<double>(2, n, 50);
        assign(X, [&](std::size_t i) { return weighted(terms) + distance * X[i]; });
        SplitStages updated = X;
        const double expected = replace(updated, sum);
        SingleStages R = split_stages<float>(2, n);
        const double bound = 1e-14 * static_cast<double>(n) * expected / distance;
        EXPECT_NEAR(form_residual(R, sum, X), expected, bound) << n;
        for (std::size_t i = 0; i < 2; ++i) {
          const Matrix change = updated[i].interleaved() - X[i].interleaved();
          const double largest = change.cwiseAbs().maxCoeff();
          EXPECT_LE(largest_difference(R[i].interleaved(), change), 0x1p-24 * largest + 1e-13) << n;
          EXPECT_TRUE(fill_is_zero(R[i])) << n;
        }
      }
    }
  }
}

// Wherever it is, in whichever block of rows, and in whichever of several matrices.
TEST(LinearCombinations, TheLargestChangeIsFoundAndOneThatIsNotANumberIsSeen) {
  for (const Index n : sizes) {
    for (const Index at : {Index{0}, n / 2, n - 1}) {
      for (const std::size_t bad : {0, 1, 2}) {
        auto X = random_stages<double>(3, n, 1);
        const auto Y = random_stages<double>(3, n, 5);
        X[bad].entries() *= 100.0;
        const double expected = X[bad].interleaved().norm();
        EXPECT_NEAR(largest_norm(X), expected, 1e-14 * expected) << n;
        X[bad].im()[at * X[bad].stride() + (n - 1 - at)] = std::numeric_limits<double>::quiet_NaN();
        const auto sum = [&](std::size_t i) { return 0.5 * X[i] + Y[i]; };
        SingleStages R = split_stages<float>(3, n);
        EXPECT_TRUE(std::isnan(largest_norm(X)));
        EXPECT_TRUE(std::isnan(form_residual(R, sum, Y)));
        EXPECT_TRUE(std::isnan(largest_norm(R)));
        auto replaced = Y;
        EXPECT_TRUE(std::isnan(replace(replaced, sum)));
        for (std::size_t i = 0; i < 3; ++i) {
          EXPECT_EQ(replaced[i].entries().allFinite(), i != bad);
        }
      }
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
