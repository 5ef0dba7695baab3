// Products of each backend against the definition; quadratic algebras.
#include <limits>

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class ProductsOfEachBackend : public ::testing::TestWithParam<ProductBackend> {};

TEST_P(ProductsOfEachBackend, AgreeWithTheDefinitionAtOddAndEvenSizes) {
  for (const Index n : {1, 2, 3, 5, 8, 16, 17, 33, 40, 65}) {
    const Matrix A = random_matrix(n, 1);
    const Matrix B = random_matrix(n, 2);
    Matrix C = Matrix::Constant(n, n, 7.0);  // what was there must not matter
    Products products(GetParam(), n);
    // Normwise bound of a sum of n products in any order: n u per entry, both parts, twice over.
    const double bound = 4.0 * static_cast<double>(n) * 1.2e-16 * A.norm() * B.norm();
    products.multiply(A, B, C, -0.5);
    EXPECT_LE((C + 0.5 * exact_product(A, B)).norm(), bound) << n;
    products.multiply_adjoint_left(A, B, C);
    EXPECT_LE((C - exact_product(A.adjoint(), B)).norm(), bound) << n;
    products.multiply_adjoint_right(A, B, C);
    EXPECT_LE((C - exact_product(A, B.adjoint())).norm(), bound) << n;
    EXPECT_EQ(products.count(), 3);
  }
}

TEST_P(ProductsOfEachBackend, PassNanThrough) {
  const Index n = 9;
  Matrix A = random_matrix(n, 1);
  A(4, 5) = nan;
  const Matrix B = random_matrix(n, 2);
  Matrix C(n, n);
  Products products(GetParam(), n);
  products.multiply(A, B, C);
  EXPECT_TRUE(std::isnan(C(4, 0).real()));
  EXPECT_TRUE(std::isfinite(C(3, 0).real()));
}

TEST_P(ProductsOfEachBackend, RefuseAliasesAndWrongSizes) {
  Matrix A = random_matrix(6, 1);
  const Matrix B = random_matrix(6, 2);
  const Matrix small = random_matrix(5, 3);
  Products products(GetParam(), 6);
  EXPECT_THROW(products.multiply(A, B, A), std::invalid_argument);
  EXPECT_THROW(products.multiply(B, A, A), std::invalid_argument);
  EXPECT_THROW(products.multiply(B, small, A), std::invalid_argument);
  EXPECT_EQ(products.count(), 0);
  EXPECT_THROW(Products(GetParam(), 0), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Backends, ProductsOfEachBackend, ::testing::ValuesIn(product_backends()),
                         [](const auto& tested) { return std::string(name(tested.param)); });

// A dense J with J² = -I: the symplectic one in other coordinates, by an orthogonal matrix.
Matrix dense_symplectic_J(Index k) {
  const Matrix Q = exponential(random_skew_hermitian(2 * k, 5));
  return product({Q, symplectic_J(k), inverse(Q)});
}

std::vector<Matrix> various_J() {
  return {symplectic_J(2), indefinite_J(3, 1), Complex(0.0, 2.0) * indefinite_J(2, 3),
          dense_symplectic_J(2)};
}

TEST(QuadraticAlgebra, HasTheMapsOfItsFormulasAndDefectsThatVanishOnAlgebraAndGroupOnly) {
  for (const Matrix& J : various_J()) {
    const QuadraticAlgebra algebra(J);
    const Matrix X = random_matrix(J.rows(), 1);
    Matrix mirrored(J.rows(), J.rows()), conjugated = mirrored;
    algebra.involution(X, mirrored);
    EXPECT_LE(largest_difference(mirrored, product({inverse(J), X.adjoint(), J})), 1e-14);
    algebra.conjugate_by_J(X, conjugated);
    EXPECT_LE(largest_difference(conjugated, product({J, X, inverse(J)})), 1e-14);
    // Two products of sums of n terms of order 1 mirror, and two more measure: each rounds n times.
    const double rounding = 4.0 * static_cast<double>(J.rows()) * 2.2e-16;
    EXPECT_LE(algebra.algebra_defect(X - mirrored), rounding);
    EXPECT_GE(algebra.algebra_defect(X), 0.1);
    EXPECT_LE(algebra.group_defect(Matrix::Identity(J.rows(), J.rows())), 1e-15);
    EXPECT_GE(algebra.group_defect(X), 0.1);
  }
}

TEST(QuadraticAlgebra, RefusesAJWhoseSquareIsNotAMultipleOfTheIdentity) {
  EXPECT_THROW(QuadraticAlgebra(random_matrix(3, 1)), std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra(Matrix::Zero(3, 3)), std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra(Matrix::Zero(2, 3)), std::invalid_argument);
  Matrix broken = Matrix::Identity(3, 3);
  broken(1, 1) = nan;
  EXPECT_THROW(QuadraticAlgebra{broken}, std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra::skew_hermitian(0), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
