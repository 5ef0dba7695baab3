#include "isosyrk/flows/laplacian.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// ΔW = -Σ_a [S_a, [S_a, W]] with the spin matrices written out.
Matrix laplacian_by_commutators(const Matrix& W) {
  Matrix sum = Matrix::Zero(W.rows(), W.cols());
  for (const Matrix& S : spin_matrices(W.rows())) sum -= commutator(S, commutator(S, W));
  return sum;
}

TEST(Laplacian, IsTheDoubleCommutatorWithTheSpinMatrices) {
  for (const Index n : {2, 3, 6, 17}) {
    const Matrix W = random_matrix(n, 1);
    Matrix out(n, n);
    Laplacian(n).apply(W, out);
    // Entries of size n²; 10 roundings each.
    EXPECT_LE(largest_difference(out, laplacian_by_commutators(W)),
              10.0 * 2.3e-16 * static_cast<double>(n * n * 4));
  }
}

TEST(Laplacian, IsInvertedBySolving) {
  for (const Index n : {2, 3, 4, 5, 16, 17, 33, 64, 65}) {
    Matrix W = random_skew_hermitian(n, 1);
    W -= W.trace() / static_cast<double>(n) * Matrix::Identity(n, n);
    Matrix P(n, n);
    Matrix back(n, n);
    const Laplacian laplacian(n);
    laplacian.solve_skew_hermitian(W, 0.25, P);
    laplacian.apply(P, back);
    // Rounding times the condition number, which is (n-1)n/2.
    EXPECT_LE(largest_difference(back, 0.25 * W), 1e-15 * static_cast<double>(n * n)) << n;
  }
}

TEST(PoissonSolve, TakesTheTraceOutOfItsRightHandSide) {
  const Index n = 17;
  const Laplacian laplacian(n);
  const Matrix W = random_skew_hermitian(n, 2);
  Matrix P(n, n);
  Matrix shifted(n, n);
  laplacian.solve_skew_hermitian(W, 1.0, P);
  laplacian.solve_skew_hermitian(W + Complex(0.0, 3.0) * Matrix::Identity(n, n), 1.0, shifted);
  EXPECT_LE(largest_difference(P, shifted), 1e-14);
  EXPECT_LE(std::abs(P.trace()), 1e-15);
}

TEST(PoissonSolve, IsSkewHermitianExactlyWhateverRoundingLeftInItsArgument) {
  for (const Index n : {2, 7, 17, 32}) {
    Matrix W = random_skew_hermitian(n, 3);
    Matrix P(n, n);
    W += 1e-12 * random_matrix(n, 4);
    Laplacian(n).solve_skew_hermitian(W, 1.7, P);
    EXPECT_EQ(skew_defect(P), 0.0);
  }
}

TEST(Laplacian, RefusesSizesBelow2) { EXPECT_THROW(Laplacian(1), std::invalid_argument); }

}  // namespace
}  // namespace isosyrk::testing
