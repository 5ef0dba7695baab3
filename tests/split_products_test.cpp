// Split products against the plain loop, for every vector unit that runs here.
#include "isosyrk/split/split_products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double unit_roundoff = 0x1p-53;

// As the definition reads, in extended precision.
Matrix exact_product(const Matrix& A, const Matrix& B) {
  const Index n = A.rows();
  Matrix C(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      std::complex<long double> sum = 0.0L;
      for (Index k = 0; k < n; ++k) {
        sum += std::complex<long double>(A(i, k)) * std::complex<long double>(B(k, j));
      }
      C(i, j) = Complex(static_cast<double>(sum.real()), static_cast<double>(sum.imag()));
    }
  }
  return C;
}

bool fill_is_zero(const SplitMatrix& X) {
  for (Index r = 0; r < X.size(); ++r) {
    for (Index c = X.size(); c < X.stride() / 2; ++c) {
      if (X.re()[r * X.stride() + c] != 0.0 || X.im()[r * X.stride() + c] != 0.0) return false;
    }
  }
  return true;
}

// Every rest of rows and columns, and sizes on both sides of where AVX2 copies B.
std::vector<Index> tested_sizes() {
  std::vector<Index> sizes = {47, 63, 64, 65, 71, 72, 73, 80, 97, 101, 128, 129, 140};
  for (Index n = 1; n <= 36; ++n) sizes.push_back(n);
  return sizes;
}

class EachUnit : public ::testing::TestWithParam<GemmKernel> {};

TEST_P(EachUnit, ProductsAreRightToRoundingForEverySize) {
  for (const Index n : tested_sizes()) {
    SplitProducts products(n, GetParam());
    const auto seed = static_cast<unsigned>(n);
    const Matrix A = random_matrix(n, seed);
    const Matrix B = random_matrix(n, seed + 1000);
    const double bound = 4.0 * static_cast<double>(n) * unit_roundoff * A.norm() * B.norm();
    SplitMatrix C(n);
    const SplitMatrix a(A), b(B);
    products.form(times(a, b, C, -0.3));
    EXPECT_LE((C.interleaved() + 0.3 * exact_product(A, B)).norm(), bound) << n;
    EXPECT_TRUE(fill_is_zero(C)) << n;
    products.form(adjoint_times(a, b, C));
    EXPECT_LE((C.interleaved() - exact_product(A.adjoint(), B)).norm(), bound) << n;
    EXPECT_TRUE(fill_is_zero(C)) << n;
    EXPECT_EQ(products.count(), 2);
  }
}

TEST_P(EachUnit, SkewHermitianProductsAreRightAndExactlySkew) {
  for (const Index n : tested_sizes()) {
    SplitProducts products(n, GetParam());
    const auto seed = static_cast<unsigned>(n);
    const Matrix Q = random_matrix(n, seed);
    const Matrix W = random_skew_hermitian(n, seed);
    const Matrix WQ = exact_product(W, Q);
    const double bound = 4.0 * static_cast<double>(n) * unit_roundoff * Q.norm() * WQ.norm();
    SplitMatrix C(n);
    const SplitMatrix q(Q), q_adjoint(Q.adjoint()), wq(WQ);
    products.form(adjoint_times(q, wq, C).upper_triangle());
    mirror_skew(C);
    const Matrix found = C.interleaved();
    EXPECT_LE((found - exact_product(Q.adjoint(), WQ)).norm(), bound) << n;
    EXPECT_EQ((found + found.adjoint()).norm(), 0.0) << n;
    EXPECT_TRUE(fill_is_zero(C)) << n;
    products.form(times(q_adjoint, wq, C, 2.0).upper_triangle());
    mirror_skew(C);
    EXPECT_LE((C.interleaved() - 2.0 * found).norm(), 4.0 * bound) << n;
    EXPECT_EQ(products.count(), 2);
    EXPECT_EQ(products.equivalents(), 1.0);
  }
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
        const Matrix found = C.interleaved();
        for (Index i = 0; i < n; ++i) {
          for (Index j = 0; j < n; ++j) {
            const bool touched = i == at || j == at;
            EXPECT_EQ(std::isfinite(found(i, j).real()) && std::isfinite(found(i, j).imag()),
                      !touched)
                << n << " " << i << " " << j;
          }
        }
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
  const Matrix found = C.interleaved();
  const Matrix wanted = exact_product(A, B);
  EXPECT_GT(found.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_LE((found - wanted).cwiseAbs().maxCoeff(), 100.0 * 0x1p-1074);
}

INSTANTIATE_TEST_SUITE_P(Split, EachUnit, ::testing::ValuesIn(tested_kernels()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(SplitProducts, RefuseAliasesOtherSizesAndThreads) {
  SplitProducts products(5);
  SplitMatrix A(5);
  SplitMatrix B(5);
  SplitMatrix other(6);
  SplitMatrix C(5);
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
  for (const int threads : {-1, 0, 65}) {
    EXPECT_THROW(SplitProducts(5, threads), std::invalid_argument);
  }
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

TEST(SplitMatrix, GivesBackWhatWasLoaded) {
  for (const Index n : {1, 2, 5, 17}) {
    const Matrix W = random_matrix(n, 1);
    SplitMatrix X(n);
    EXPECT_EQ(X.interleaved(), Matrix::Zero(n, n));
    X.load(W);
    EXPECT_EQ(X.interleaved(), W);
    EXPECT_TRUE(fill_is_zero(X));
    Matrix back = Matrix::Zero(n, n);
    X.store(back);
    EXPECT_EQ(back, W);
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
