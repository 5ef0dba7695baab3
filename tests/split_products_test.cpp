// Split products against the plain loop, for every vector unit that runs here.
#include "isosyrk/split/split_products.h"

#include <cmath>
#include <limits>

#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

template <class Real>
constexpr double unit_roundoff = 0.5 * std::numeric_limits<Real>::epsilon();

// Every rest of rows and columns, and sizes on both sides of where AVX2 copies B.
std::vector<Index> tested_sizes() {
  std::vector<Index> sizes = {47, 63,  64,  65,  71,  72,  73,  80,
                              97, 101, 104, 105, 107, 128, 129, 140};
  for (Index n = 1; n <= 36; ++n) sizes.push_back(n);
  return sizes;
}

class EachUnit : public ::testing::TestWithParam<GemmKernel> {};

// Of any matrices; and of Q† and WQ with a skew-Hermitian W, from the upper triangle.
template <class Real>
void expect_right_to_rounding(const GemmKernel& kernel) {
  for (const Index n : tested_sizes()) {
    SCOPED_TRACE(n);
    SplitProductsOf<Real> products(n, kernel);
    const auto seed = static_cast<unsigned>(n);
    const auto split = [](const Matrix& A) { return SplitMatrixOf<Real>(A); };
    const auto a = split(random_matrix(n, seed)), b = split(random_matrix(n, seed + 1000));
    const Matrix A = a.interleaved(), B = b.interleaved();  // what the rounding has left
    const double roundings = 4.0 * static_cast<double>(n) * unit_roundoff<Real>;
    SplitMatrixOf<Real> C(n);
    const auto expect = [&](const Matrix& expected, double bound) {
      EXPECT_LE((C.interleaved() - expected).norm(), bound);
      EXPECT_TRUE(fill_is_zero(C));
    };
    products.form(times(a, b, C, static_cast<Real>(-0.5)));
    expect(-0.5 * exact_product(A, B), roundings * A.norm() * B.norm());
    products.form(adjoint_times(a, b, C));
    expect(exact_product(A.adjoint(), B), roundings * A.norm() * B.norm());

    const auto wa = split(exact_product(random_skew_hermitian(n, seed), A));
    const auto a_adjoint = split(A.adjoint());
    const Matrix WA = wa.interleaved(), expected = exact_product(A.adjoint(), WA);
    products.form(adjoint_times(a, wa, C).upper_triangle());
    mirror_skew(C);
    expect(expected, roundings * A.norm() * WA.norm());
    EXPECT_EQ(skew_defect(C.interleaved()), 0.0);
    products.form(times(a_adjoint, wa, C, Real{2}).upper_triangle());
    mirror_skew(C);
    expect(2.0 * expected, 4.0 * roundings * A.norm() * WA.norm());
    EXPECT_EQ(products.count(), 4);
    EXPECT_EQ(products.equivalents(), 3.0);
  }
}

TEST_P(EachUnit, ProductsAreRightToRoundingForEverySizeAndSkewHermitianOnesExactlySkew) {
  expect_right_to_rounding<double>(GetParam());
  expect_right_to_rounding<float>(GetParam());
}

TEST_P(EachUnit, WhatIsNotFinitePassesAsInThePlainLoop) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Index n : {5, 17, 20, 33, 75}) {
    for (const double bad : {infinity, -infinity, std::nan("")}) {
      for (const Index at : {Index{0}, n / 2, n - 1}) {
        SplitProducts products(n, GetParam());
        Matrix A = random_matrix(n, 1);
        Matrix B = random_matrix(n, 2);
        A(at, n - 1) = {bad, 0.0};
        B(0, at) = {0.0, bad};
        SplitMatrix C(n);
        const SplitMatrix a(A), b(B), third(random_matrix(n, 3)), fourth(random_matrix(n, 4));
        products.form(times(a, b, C));
        const Matrix found = C.interleaved(), ones = Matrix::Ones(n, n);
        const auto is_finite = [&](Index i, Index j) { return found.row(i).col(j).allFinite(); };
        const auto is_untouched = [at](Index i, Index j) { return i != at && j != at; };
        EXPECT_EQ(entries_of(ones, is_finite), entries_of(ones, is_untouched));
        EXPECT_TRUE(fill_is_zero(C));
        products.form(times(b, third, C));
        products.form(times(fourth, third, C));
        EXPECT_TRUE(C.entries().allFinite()) << "nothing of an earlier product stays";
      }
    }
  }
}

TEST_P(EachUnit, DenormalsAreNotLost) {
  constexpr Index n = 17;
  SplitProducts products(n, GetParam());
  const Matrix A = 1e-160 * random_matrix(n, 1);
  const Matrix B = 1e-160 * random_matrix(n, 2);
  SplitMatrix C(n);
  const SplitMatrix a(A), b(B);
  products.form(times(a, b, C));
  EXPECT_GT(C.interleaved().cwiseAbs().maxCoeff(), 0.0);
  EXPECT_LE(largest_difference(C.interleaved(), exact_product(A, B)), 100.0 * 0x1p-1074);
}

INSTANTIATE_TEST_SUITE_P(Split, EachUnit, ::testing::ValuesIn(tested_kernels()),
                         ::testing::PrintToStringParamName());

TEST(SplitProducts, RefuseAliasesOtherSizesAndThreads) {
  SplitProducts products(5);
  SplitMatrix A(5), B(5), C(5), other(6);
  for (const bool adjoint : {false, true}) {
    const auto form = [&](const SplitMatrix& left, const SplitMatrix& right, SplitMatrix& out) {
      products.form(adjoint ? adjoint_times(left, right, out) : times(left, right, out));
    };
    EXPECT_THROW(form(A, B, A), std::invalid_argument);
    EXPECT_THROW(form(A, B, B), std::invalid_argument);
    EXPECT_THROW(form(A, B, other), std::invalid_argument);
    EXPECT_THROW(form(other, B, C), std::invalid_argument);
    EXPECT_THROW(form(A, other, C), std::invalid_argument);
  }
  EXPECT_THROW(SplitProducts(0), std::invalid_argument);
  EXPECT_THROW(SplitProducts(5, 65), std::invalid_argument);
  const ThreadScope two(2);
  EXPECT_THROW(products.form(times(A, B, C)), std::invalid_argument);
  EXPECT_EQ(products.count(), 0);
}

TEST(SplitRow, IsWholeVectorsAndTwoAreNoMultipleOfAPage) {
  for (Index n = 1; n <= 2000; ++n) {
    EXPECT_GE(split_row<double>(n), n + 3);
    EXPECT_EQ(split_row<double>(n) % 8, 0);
    EXPECT_NE(2 * split_row<double>(n) % 512, 0);
    EXPECT_EQ(split_row<float>(n) % 16, 0);
    EXPECT_NE(2 * split_row<float>(n) % 1024, 0);
  }
}

TEST_P(EachUnit, ABatchIsItsProductsOneByOne) {
  for (const Index n : {5, 17, 75}) {
    SplitProducts products(n, GetParam());
    const SplitMatrix A(random_matrix(n, 1)), B(random_matrix(n, 2));
    SplitStages C = split_stages(3, n), expected = C;
    const auto product_into = [&](SplitStages& out) {
      return [&](std::size_t i) {
        return i == 0   ? times(A, B, out[0], 0.7)
               : i == 1 ? adjoint_times(A, B, out[1])
                        : times(B, A, out[2]).upper_triangle();
      };
    };
    const auto product_of = product_into(expected);
    for (std::size_t i = 0; i < 3; ++i) products.form(product_of(i));
    products.form(3, product_into(C));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(C[i].entries(), expected[i].entries()) << n;
    EXPECT_EQ(products.count(), 6);
    EXPECT_EQ(products.equivalents(), 5.0);
  }
}

}  // namespace
}  // namespace isosyrk::testing
