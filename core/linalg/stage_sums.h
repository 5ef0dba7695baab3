// Linear combinations of stage matrices, and the change of an unknown, in one pass over memory.
//
// The sums over stages cost O(s² n²) beside the products' O(s n³).  All coefficients are real, so a
// matrix is seen as its 2n² real numbers; each matrix is read once, and everything that is wanted of
// a few of these numbers is done while they are in registers.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

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

namespace stage_sums {

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

}  // namespace stage_sums

/// out = Σ_j weights(j) Y_j, at least one term.  `weights` is any vector expression of doubles; out
/// is none of the Y_j.
template <class Weights>
void combine(const Weights& weights, const std::vector<Matrix>& Y, Matrix& out) {
  stage_sums::combine(weights, Y, out, [&](const auto& sum) { reals(out) = sum; });
}

/// out = base + Σ_j weights(j) Y_j, at least one term.  out is neither base nor a Y_j.
template <class Weights>
void combine(const Matrix& base, const Weights& weights, const std::vector<Matrix>& Y,
             Matrix& out) {
  stage_sums::combine(weights, Y, out, [&](const auto& sum) { reals(out) = reals(base) + sum; });
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

}  // namespace isosyrk
