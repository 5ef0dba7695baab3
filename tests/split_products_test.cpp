// Split products for every vector unit that runs here: against the plain loop; and products of
// banded factors, by several threads, against those of full matrices by one, bit for bit.
#include "isosyrk/split/split_products.h"

#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <vector>

#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk {

inline void PrintTo(const GemmKernel& kernel, std::ostream* out) { *out << kernel.name; }

}  // namespace isosyrk

namespace isosyrk::testing {
namespace {

// Every kernel that runs here, by itself and, named ..._copies, with copies of the factors at any
// size.
std::vector<GemmKernel> tested_kernels() {
  static std::list<std::string> names;
  std::vector<GemmKernel> tested;
  for (GemmKernel kernel : gemm_kernels()) {
    tested.push_back(kernel);
    kernel.name = names.emplace_back(kernel.name + std::string("_copies")).c_str();
    kernel.doubles.limits = kernel.singles.limits = {0, 0};
    tested.push_back(kernel);
  }
  return tested;
}

template <class Real>
constexpr double unit_roundoff = 0.5 * std::numeric_limits<Real>::epsilon();

// Every rest of rows and columns, and sizes on both sides of where AVX2 copies B.
std::vector<Index> tested_sizes() {
  std::vector<Index> sizes = {47, 63,  64,  65,  71,  72,  73,  80,
                              97, 101, 104, 105, 107, 128, 129, 140};
  for (Index n = 1; n <= 36; ++n) sizes.push_back(n);
  return sizes;
}

class EachKernel : public ::testing::TestWithParam<GemmKernel> {};

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
    products.form(into(C, -0.5 * a * b));
    expect(-0.5 * exact_product(A, B), roundings * A.norm() * B.norm());
    products.form(into(C, adjoint(a) * b));
    expect(exact_product(A.adjoint(), B), roundings * A.norm() * B.norm());

    const auto wa = split(exact_product(random_skew_hermitian(n, seed), A));
    const auto a_adjoint = split(A.adjoint());
    const Matrix WA = wa.interleaved(), expected = exact_product(A.adjoint(), WA);
    products.form(into(C, adjoint(a) * wa).upper_triangle());
    mirror_skew(C);
    expect(expected, roundings * A.norm() * WA.norm());
    EXPECT_EQ(skew_defect(C.interleaved()), 0.0);
    products.form(into(C, 2.0 * a_adjoint * wa).upper_triangle());
    mirror_skew(C);
    expect(2.0 * expected, 4.0 * roundings * A.norm() * WA.norm());
    EXPECT_EQ(products.count(), 4);
    EXPECT_EQ(products.equivalents(), 3.0);
  }
}

TEST_P(EachKernel, ProductsAreRightToRoundingForEverySizeAndSkewHermitianOnesExactlySkew) {
  expect_right_to_rounding<double>(GetParam());
  expect_right_to_rounding<float>(GetParam());
}

TEST_P(EachKernel, WhatIsNotFinitePassesAsInThePlainLoop) {
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
        products.form(into(C, a * b));
        const Matrix found = C.interleaved(), ones = Matrix::Ones(n, n);
        const auto is_finite = [&](Index i, Index j) { return found.row(i).col(j).allFinite(); };
        const auto is_untouched = [at](Index i, Index j) { return i != at && j != at; };
        EXPECT_EQ(entries_of(ones, is_finite), entries_of(ones, is_untouched));
        EXPECT_TRUE(fill_is_zero(C));
        products.form(into(C, b * third));
        products.form(into(C, fourth * third));
        EXPECT_TRUE(C.entries().allFinite()) << "nothing of an earlier product stays";
      }
    }
  }
}

TEST(SplitProducts, RefuseAliasesOtherSizesAndThreads) {
  SplitProducts products(5);
  SplitMatrix A(5), B(5), C(5), other(6);
  for (const bool adjoint_left : {false, true}) {
    const auto form = [&](const SplitMatrix& left, const SplitMatrix& right, SplitMatrix& out) {
      products.form(into(out, adjoint_left ? adjoint(left) * right : left * right));
    };
    EXPECT_THROW(form(A, B, A), std::invalid_argument);
    EXPECT_THROW(form(A, B, B), std::invalid_argument);
    EXPECT_THROW(form(A, B, other), std::invalid_argument);
    EXPECT_THROW(form(other, B, C), std::invalid_argument);
    EXPECT_THROW(form(A, other, C), std::invalid_argument);
  }
  EXPECT_THROW(SplitProducts(0), std::invalid_argument);
  EXPECT_THROW(SplitProducts(5, 65), std::invalid_argument);
  on_threads(2, [&] { EXPECT_THROW(products.form(into(C, A * B)), std::invalid_argument); });
  EXPECT_EQ(products.count(), 0);
}

TEST(SplitRow, IsWholeVectorsAndTwoAreNoMultipleOfAPage) {
  for (Index n = 1; n <= 2000; ++n) {
    EXPECT_GE(split_row<double>(n), n + 7);
    EXPECT_EQ(split_row<double>(n) % 8, 0);
    EXPECT_NE(2 * split_row<double>(n) % 512, 0);
    EXPECT_EQ(split_row<float>(n) % 16, 0);
    EXPECT_NE(2 * split_row<float>(n) % 1024, 0);
  }
}

// Which entries are nonzero or needed.
struct Shape {
  bool adjoint;
  bool upper;
  Index A_band;
  Index B_band;
  Index C_band;

  bool needs(Index r, Index c) const { return std::abs(r - c) <= C_band && !(upper && r > c); }
};

std::vector<Shape> shapes(Index n) {
  const Index full = n - 1;
  std::vector<Shape> all;
  for (const bool adjoint : {false, true}) {
    for (const bool upper : {false, true}) {
      for (const auto& [A, B, C] : std::vector<std::array<Index, 3>>{{full, full, full},
                                                                     {n / 3, n / 2, full},
                                                                     {n / 4, full, n / 3},
                                                                     {n / 6, full, full},
                                                                     {full, n / 6, full},
                                                                     {0, 0, full},
                                                                     {0, full, n / 4},
                                                                     {full, 2, full},
                                                                     {4, 7, n / 4},
                                                                     {n - 2, 1, full}}) {
        all.push_back({adjoint, upper, A, B, C});
      }
    }
  }
  return all;
}

// C = -0.3 A B or -0.3 A† B in this shape, from what lies within the bands alone, in one range of
// rows and in ranges that threads form, is that of full matrices.  What was there before is not
// read.
template <class Real>
void expect_as_of_full_matrices(const GemmKernel& kernel, Index n, const Shape& shape) {
  SplitMatrixOf<Real> A(random_matrix(n, 1)), B(random_matrix(n, 2)), whole(n);
  cut_to_band(A, shape.A_band);
  cut_to_band(B, shape.B_band);
  const SplitMatrixOf<Real> full_A(A.interleaved()), full_B(B.interleaved());
  constexpr int most_threads = 7;
  SplitProductsOf<Real> products(n, kernel, most_threads);
  const auto scale = static_cast<Real>(-0.3);
  products.form(
      {.C = &whole, .A = &full_A, .B = &full_B, .scale = scale, .adjoint = shape.adjoint});
  const auto is_needed = [&](Index r, Index c) { return shape.needs(r, c); };
  const Matrix wanted = entries_of(whole.interleaved(), is_needed);
  for (const int threads : {1, 2, 3, most_threads}) {
    SplitMatrixOf<Real> C(Matrix(Matrix::Constant(n, n, Complex(std::nan(""), std::nan("")))));
    on_threads(threads, [&] {
      products.form({.C = &C,
                     .A = &A,
                     .B = &B,
                     .scale = scale,
                     .adjoint = shape.adjoint,
                     .upper = shape.upper,
                     .band = shape.C_band});
    });
    EXPECT_EQ(entries_of(C.interleaved(), is_needed), wanted) << threads;
  }
}

// What bands leave out is 0 times something.
void expect_as_of_full_matrices(const GemmKernel& kernel, std::initializer_list<Index> sizes) {
  for (const Index n : sizes) {
    for (const Shape& shape : shapes(n)) {
      SCOPED_TRACE(::testing::Message()
                   << "n = " << n << ", adjoint " << shape.adjoint << ", upper " << shape.upper
                   << ", bands " << shape.A_band << " " << shape.B_band << " " << shape.C_band);
      expect_as_of_full_matrices<double>(kernel, n, shape);
      expect_as_of_full_matrices<float>(kernel, n, shape);
    }
  }
}

TEST_P(EachKernel, FormsEachEntryBitForBitAsOfFullMatricesInAnyShapeAndByAnyNumberOfThreads) {
  expect_as_of_full_matrices(GetParam(), {4, 17, 20, 33, 49, 65, 66, 73});
}

TEST_P(EachKernel, FormsEachEntryBitForBitAsOfFullMatricesAtLargeSizes) {
  expect_as_of_full_matrices(GetParam(), {107, 129});
}

INSTANTIATE_TEST_SUITE_P(Split, EachKernel, ::testing::ValuesIn(tested_kernels()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
