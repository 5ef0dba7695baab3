#include "isosyrk/linalg/quadratic_algebra.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// A dense J with J² = -I: the symplectic one in other coordinates, by an orthogonal matrix.
Matrix dense_symplectic_J(Index k) {
  const Matrix Q = exponential(random_skew_hermitian(2 * k, 5));
  return product({Q, symplectic_J(k), inverse(Q)});
}

std::vector<Matrix> various_J() {
  return {symplectic_J(2), indefinite_J(3, 1), Complex(0.0, 2.0) * indefinite_J(2, 3),
          dense_symplectic_J(2)};
}

TEST(QuadraticAlgebra, InvolutionAndConjugationAreTheirFormulas) {
  for (const Matrix& J : various_J()) {
    const QuadraticAlgebra algebra(J);
    const Matrix X = random_matrix(J.rows(), 1);
    Matrix out(J.rows(), J.rows());
    algebra.involution(X, out);
    EXPECT_LE(largest_difference(out, product({inverse(J), X.adjoint(), J})), 1e-14);
    algebra.conjugate_by_J(X, out);
    EXPECT_LE(largest_difference(out, product({J, X, inverse(J)})), 1e-14);
  }
}

TEST(QuadraticAlgebra, DefectsVanishOnTheAlgebraAndTheIdentityAndNotOnARandomMatrix) {
  for (const Matrix& J : various_J()) {
    const QuadraticAlgebra algebra(J);
    const Matrix X = random_matrix(J.rows(), 1);
    Matrix mirrored(J.rows(), J.rows());
    algebra.involution(X, mirrored);
    EXPECT_LE(algebra.algebra_defect(X - mirrored), 1e-15);
    EXPECT_GE(algebra.algebra_defect(X), 0.1);
    EXPECT_LE(algebra.group_defect(Matrix::Identity(J.rows(), J.rows())), 1e-15);
    EXPECT_GE(algebra.group_defect(X), 0.1);
  }
}

TEST(QuadraticAlgebra, RefusesAJWhoseSquareIsNotAMultipleOfTheIdentity) {
  EXPECT_THROW(QuadraticAlgebra(random_matrix(3, 1)), std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra(Matrix::Zero(3, 3)), std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra(Matrix::Zero(2, 3)), std::invalid_argument);
  Matrix nan = Matrix::Identity(3, 3);
  nan(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(QuadraticAlgebra{nan}, std::invalid_argument);
  EXPECT_THROW(QuadraticAlgebra::skew_hermitian(0), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
