// The operations on n x n matrices that published forms are written in, beside the products of
// products.h and B of the flow: linear combinations of stage matrices, commutators from one
// product, and updates of an unknown that return how much it changed.  A form touches no entry of a
// matrix.
//
// Sums over stages cost O(s² n²) beside the products' O(s n³).  All their coefficients are real, so
// a matrix is seen as its 2n² real numbers.  Each matrix is read once, and everything that is
// wanted of a few of these numbers is done while they are in registers.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// The 2n² real numbers of X, in storage order.
inline Eigen::Map<Eigen::ArrayXd> reals(Matrix& X) {
  return {reinterpret_cast<double*>(X.data()), 2 * X.size()};
}
inline Eigen::Map<const Eigen::ArrayXd> reals(const Matrix& X) {
  return {reinterpret_cast<const double*>(X.data()), 2 * X.size()};
}

/// s matrices of size n x n, zero.
inline std::vector<Matrix> stage_matrices(Index s, Index n) {
  return std::vector<Matrix>(static_cast<std::size_t>(s), Matrix::Zero(n, n));
}

namespace operations {

/// Calls set(sum) with the sum of the first terms weights(j) Y_j, up to three, as an expression to
/// be evaluated in one pass; the rest is added to out one term at a time.
template <class Weights, class Set>
void combine(const Weights& weights, const std::vector<Matrix>& Y, Matrix& out, Set&& set) {
  const auto term = [&](std::size_t j) { return weights(static_cast<Index>(j)) * reals(Y[j]); };
  switch (Y.size()) {
    case 1:
      set(term(0));
      return;
    case 2:
      set(term(0) + term(1));
      return;
    default:
      set(term(0) + term(1) + term(2));
      break;
  }
  for (std::size_t j = 3; j < Y.size(); ++j) reals(out) += term(j);
}

}  // namespace operations

/// out = Σ_j weights(j) Y_j, at least one term.  `weights` is any vector expression of doubles; out
/// is none of the Y_j.
template <class Weights>
void combine(const Weights& weights, const std::vector<Matrix>& Y, Matrix& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = sum; });
}

/// out = base + Σ_j weights(j) Y_j, at least one term.  out is neither base nor a Y_j.
template <class Weights>
void combine(const Matrix& base, const Weights& weights, const std::vector<Matrix>& Y,
             Matrix& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = reals(base) + sum; });
}

/// Σ |fresh - old|² over all entries.
inline double squared_change(const Matrix& fresh, const Matrix& old) {
  return (reals(fresh) - reals(old)).square().sum();
}

/// The largest change of several unknowns from the squares of their changes; NaN if any is.
inline double largest_change(const RealVector& squares) {
  double largest = 0.0;
  for (const double square : squares) largest = larger(largest, square);
  return std::sqrt(largest);
}

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, each Y_j read once; squares[i] = Σ |change of X_i|².
/// a is s x s, s = Y.size() = X.size() <= max_stages.
void update_unknowns(const Matrix& base, double h, const RealMatrix& a,
                     const std::vector<Matrix>& Y, std::vector<Matrix>& X, double* squares);

/// W = W₀ + (S - J⁻¹ Y† J); returns Σ |change of W|².  With S = Y + Σ_j a_ij K_ij this is the stage
/// vorticity of the algebra formulation.  `scratch` is n x n where J is not I, and otherwise not
/// touched.  W is none of the others.
double update_stage_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& S,
                              const Matrix& Y, Matrix& scratch, Matrix& W);

/// W = W₀ + a (M - J⁻¹ M† J) + b MB; returns Σ |change of W|².  With M = B W̃, a = h/2, b = h²/4
/// this is the stage vorticity of the isospectral midpoint rule.  `scratch` as above.  W is none of
/// the others.
double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, double a,
                                 const Matrix& M, double b, const Matrix& MB, Matrix& scratch,
                                 Matrix& W);

/// out = C - J⁻¹ C† J, which for C = A B with A, B in g is [A, B].  `scratch` as above.  out is not
/// C.
void commutator_of_product(const QuadraticAlgebra& algebra, const Matrix& C, Matrix& scratch,
                           Matrix& out);

/// out = W₀ + C - J⁻¹ C† J.  For C = Σ w_i B_i W̃_i with B_i, W̃_i in g this is
/// W₀ + Σ w_i [B_i, W̃_i], and in g exactly for J = I: both triangles round alike.
/// `scratch` as above.  out is neither W₀ nor C.
void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out);

}  // namespace isosyrk
