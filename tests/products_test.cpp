#include "isosyrk/linalg/products.h"

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

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
  A(4, 5) = std::numeric_limits<double>::quiet_NaN();
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

}  // namespace
}  // namespace isosyrk::testing
