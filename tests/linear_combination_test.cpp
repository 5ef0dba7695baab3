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
  return sum_of([](Index t) { return weight_of(static_cast<std::size_t>(t)); }, X);
}

template <class Real>
void expect_sums() {
  for (const Index n : sizes) {
    for (const std::size_t count : counts) {
      SCOPED_TRACE(::testing::Message() << n << " " << count);
      const auto X = random_stages<Real>(count, n, 1);
      Matrix expected = Matrix::Zero(n, n);
      for (std::size_t t = 0; t < count; ++t) expected += weight_of(t) * X[t].interleaved();
      SplitMatrixOf<Real> sum(n);
      assign(sum, weighted(X));
      EXPECT_EQ(sum.interleaved(), expected);
      EXPECT_TRUE(fill_is_zero(sum));

      auto replaced = random_stages<Real>(2, n, 100);
      const double change = std::max((replaced[0].interleaved() - expected).norm(),
                                     (replaced[1].interleaved() - expected).norm());
      const double found = replace(replaced, [&](std::size_t) { return weighted(X); });
      // The sum of 2 n² squares, in parts of some hundred each, errs by a few roundoffs relatively.
      EXPECT_NEAR(found, change, 64.0 * std::numeric_limits<Real>::epsilon() * change);
      for (const auto& each : replaced) EXPECT_EQ(each.entries(), sum.entries());
    }
  }
}

TEST(LinearCombinations, OfAnyNumberOfTermsAreTheirSum) {
  expect_sums<double>();
  expect_sums<float>();
}

TEST(LinearCombinations, MayReplaceOneOfTheirTerms) {
  for (const Index n : sizes) {
    for (const std::size_t count : counts) {
      const auto X = random_stages<double>(count, n, 1);
      SplitMatrix beside(n);
      assign(beside, weighted(X));
      for (const std::size_t at : {std::size_t{0}, count / 2, count - 1}) {
        SCOPED_TRACE(::testing::Message() << n << " " << count << " " << at);
        auto assigned = X;
        assign(assigned[at], weighted(assigned));
        EXPECT_EQ(assigned[at].entries(), beside.entries());

        SplitStages replaced = {X[at]};
        const double change = replace(replaced, [&](std::size_t) {
          LinearCombination<double> sum;
          for (std::size_t t = 0; t < count; ++t) {
            sum.add(weight_of(t), t == at ? replaced[0] : X[t]);
          }
          return sum;
        });
        EXPECT_EQ(replaced[0].entries(), beside.entries());
        const double expected = (beside.entries() - X[at].entries()).norm();
        EXPECT_NEAR(change, expected, 1e-14 * expected);
      }
    }
  }
}

TEST(LinearCombinations, HaveTheWidestBandOfATerm) {
  constexpr Index n = 33;
  auto X = random_stages<double>(3, n, 1);
  for (std::size_t t = 0; t < 3; ++t) cut_to_band(3 * static_cast<Index>(t) + 1, X[t]);
  SplitStages out = split_stages(1, n);
  for (std::size_t count = 1; count <= 3; ++count) {
    const SplitStages terms(X.begin(), X.begin() + static_cast<std::ptrdiff_t>(count));
    const Index widest = 3 * static_cast<Index>(count) - 2;
    const auto sum = [&](std::size_t) { return weighted(terms); };
    EXPECT_EQ(sum(0).band(), widest);
    out[0].set_band(n - 1);
    assign(out, sum);
    EXPECT_EQ(out[0].band(), widest);
    SplitStages replaced = random_stages<double>(1, n, 7);
    replace(replaced, sum);
    EXPECT_EQ(replaced[0].band(), widest);
    SingleStages R = split_stages<float>(1, n);
    residual({X[0]}, sum, R);
    EXPECT_EQ(R[0].band(), widest);
    residual({X[2]}, sum, R);
    EXPECT_EQ(R[0].band(), 7);  // of the matrix that is taken off
    SingleStages rounded = split_stages<float>(1, n);
    round_to_single({X[count - 1]}, rounded);
    EXPECT_EQ(rounded[0].band(), widest);
    SplitStages added = {X[0]};
    add(rounded, added);
    EXPECT_EQ(added[0].band(), widest);
  }
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
        assign(X, [&](std::size_t i) { return weighted(terms).add(distance, X[i]); });
        SplitStages updated = X;
        const double expected = replace(updated, sum);
        SingleStages R = split_stages<float>(2, n);
        const double bound = 1e-14 * static_cast<double>(n) * expected / distance;
        EXPECT_NEAR(residual(X, sum, R), expected, bound) << n;
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

TEST(MixedPrecision, RoundsAndAddsEntryByEntry) {
  for (const Index n : sizes) {
    const auto X = random_stages<double>(2, n, 1);
    SingleStages S = split_stages<float>(2, n);
    round_to_single(X, S);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(S[i].entries(), SingleMatrix(X[i].interleaved()).entries()) << n;
      EXPECT_TRUE(fill_is_zero(S[i])) << n;
    }
    auto sums = random_stages<double>(2, n, 3);
    const auto before = sums;
    add(S, sums);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(sums[i].interleaved(), Matrix(before[i].interleaved() + S[i].interleaved())) << n;
      EXPECT_TRUE(fill_is_zero(sums[i])) << n;
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
        const auto sum = [&](std::size_t i) { return sum_of(0.5, X[i]).add(1.0, Y[i]); };
        SingleStages R = split_stages<float>(3, n);
        EXPECT_TRUE(std::isnan(largest_norm(X)));
        EXPECT_TRUE(std::isnan(residual(Y, sum, R)));
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
