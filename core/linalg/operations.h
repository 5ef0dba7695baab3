// Operations on n x n matrices for the published forms: linear combinations of stage matrices,
// commutators from one product, and updates that return the change of an unknown.  With the
// products of products.h and the flow's B, a form needs no access to single entries.
//
// Sums over stages cost O(s² n²), products O(s n³).  All coefficients of the sums are real, so a
// matrix is read as its 2n² real numbers.  Each operation makes one pass: every matrix is read
// once, and a few numbers of all matrices are combined in registers.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Returns a view of the 2n² real numbers of X, in storage order.
inline Eigen::Map<Eigen::ArrayXd> reals(Matrix& X) {
  return {reinterpret_cast<double*>(X.data()), 2 * X.size()};
}
inline Eigen::Map<const Eigen::ArrayXd> reals(const Matrix& X) {
  return {reinterpret_cast<const double*>(X.data()), 2 * X.size()};
}

/// Returns s zero matrices of size n x n.
inline std::vector<Matrix> stage_matrices(Index s, Index n) {
  return std::vector<Matrix>(static_cast<std::size_t>(s), Matrix::Zero(n, n));
}

namespace operations {

/// Calls set(sum) once, where `sum` is an expression for the first terms weights(j) Y_j, at most
/// three.  `set` evaluates the expression in one pass.  Further terms are added to out one at a
/// time.
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

/// out = Σ_j weights(j) Y_j with at least one term.  `weights` is any vector expression of doubles.
/// out is none of the Y_j.
template <class Weights>
void combine(const Weights& weights, const std::vector<Matrix>& Y, Matrix& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = sum; });
}

/// out = base + Σ_j weights(j) Y_j with at least one term.  out is neither base nor a Y_j.
template <class Weights>
void combine(const Matrix& base, const Weights& weights, const std::vector<Matrix>& Y,
             Matrix& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = reals(base) + sum; });
}

/// Returns Σ |fresh - old|² over all entries.
inline double squared_change(const Matrix& fresh, const Matrix& old) {
  return (reals(fresh) - reals(old)).square().sum();
}

/// Returns the largest change of several unknowns, given the squares of their changes.  NaN if any
/// square is NaN.
inline double largest_change(const RealVector& squares) {
  double largest = 0.0;
  for (const double square : squares) largest = larger(largest, square);
  return std::sqrt(largest);
}

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, and squares[i] = Σ |change of X_i|².  a is s x s with
/// s = Y.size() = X.size() <= max_stages.  No X_i is base or a Y_j.
void update_unknowns(const Matrix& base, double h, const RealMatrix& a,
                     const std::vector<Matrix>& Y, std::vector<Matrix>& X, double* squares);

/// Sets W = W₀ + (S - J⁻¹ Y† J) and returns Σ |change of W|².  With S = Y + Σ_j a_ij K_ij this is
/// the stage vorticity of the algebra formulation.  `scratch` is n x n if J is not I, and unused
/// otherwise.  W is none of the other arguments.
double update_stage_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& S,
                              const Matrix& Y, Matrix& scratch, Matrix& W);

/// Sets W = W₀ + a (M - J⁻¹ M† J) + b MB and returns Σ |change of W|².  With M = B W̃, a = h/2 and
/// b = h²/4 this is the stage vorticity of the isospectral midpoint rule.  `scratch` as above.  W
/// is none of the other arguments.
double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const Matrix& W0, double a,
                                 const Matrix& M, double b, const Matrix& MB, Matrix& scratch,
                                 Matrix& W);

/// out = C - J⁻¹ C† J.  For C = A B with A, B in g this is [A, B].  `scratch` as above.  out is not
/// C.
void commutator_of_product(const QuadraticAlgebra& algebra, const Matrix& C, Matrix& scratch,
                           Matrix& out);

/// out = W₀ + C - J⁻¹ C† J.  For C = Σ w_i B_i W̃_i with B_i, W̃_i in g this is
/// W₀ + Σ w_i [B_i, W̃_i].  For J = I the result is in g exactly if W₀ is, since both triangles
/// round alike.  `scratch` as above.  out is neither W₀ nor C.
void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out);

}  // namespace isosyrk
