// The Laplacian and its inverse, on plain and on split matrices.
#include "isosyrk/flows/laplacian.h"

#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/split_laplacian.h"
#include "isosyrk/split/skew.h"
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

TEST(Laplacian, IsInvertedBySolvingWhichTakesTheTraceOutAndIsExactlySkewHermitian) {
  for (const Index n : {2, 3, 4, 5, 7, 16, 17, 32, 33, 64, 65}) {
    const Matrix W = random_skew_hermitian(n, 1);  // its trace is not 0
    const Matrix mean = W.trace() / static_cast<double>(n) * Matrix::Identity(n, n);
    const Laplacian laplacian(n);
    Matrix P(n, n), back(n, n);
    laplacian.solve_skew_hermitian(W, 0.25, P);
    laplacian.apply(P, back);
    // Rounding times the condition number, which is (n-1)n/2.
    const double bound = 1e-15 * static_cast<double>(n * n);
    EXPECT_LE(largest_difference(back, 0.25 * (W - mean)), bound) << n;
    EXPECT_LE(std::abs(P.trace()), bound) << n;
    // Whatever rounding left in the argument.
    laplacian.solve_skew_hermitian(W + 1e-12 * random_matrix(n, 4), 0.25, P);
    EXPECT_EQ(skew_defect(P), 0.0) << n;
  }
  EXPECT_THROW(Laplacian(1), std::invalid_argument);
}

template <class Real = double>
Matrix solved(const Laplacian& laplacian, const Matrix& W, double scale) {
  SplitStagesOf<Real> P = split_stages<Real>(1, W.rows());
  SplitLaplacianOf<Real>(laplacian).solve_upper(SplitStagesOf<Real>{SplitMatrixOf<Real>(W)},
                                                static_cast<Real>(scale), W.rows() - 1, P);
  mirror_skew(P);
  return P[0].interleaved();
}

TEST(SplitLaplacian, SolvesAsThePlainOneAndInSinglePrecisionToSomeDigits) {
  std::vector<Index> sizes = {129};
  for (Index n = 2; n <= 80; ++n) sizes.push_back(n);
  for (const Index n : sizes) {
    const Laplacian laplacian(n);
    const Matrix W = random_skew_hermitian(n, static_cast<unsigned>(n));  // its trace is not 0
    Matrix expected(n, n);
    laplacian.solve_skew_hermitian(W, 1.7, expected);
    const Matrix found = solved(laplacian, W, 1.7), single = solved<float>(laplacian, W, 1.7);
    EXPECT_LE(largest_difference(found, expected), 1e-14 * expected.norm()) << n;
    // The sum of n entries, each rounded; other kernels of BLAS, by which W is scaled, reach a
    // third of this bound.  A trace that is left in W gives 0.1 and more.
    const double rounding = static_cast<double>(n) * std::numeric_limits<double>::epsilon();
    EXPECT_LE(std::abs(found.trace()), rounding * expected.norm()) << n;
    EXPECT_LE((single - found).norm(), 1e-3 * found.norm()) << n;
    EXPECT_GT((single - found).norm(), 1e-9 * found.norm()) << n;  // it is single precision
    for (const Matrix& each : {found, single}) EXPECT_EQ(skew_defect(each), 0.0) << n;
  }
}

}  // namespace
}  // namespace isosyrk::testing
