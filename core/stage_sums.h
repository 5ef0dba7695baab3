// Linear combinations of stage matrices, row by row, and the change of an unknown.
//
// The sums over stages cost O(s^2 n^2) and would, done matrix by matrix, be passes over memory.
// Done row by row, a row of every stage is in the first-level cache when it is combined, stored
// and compared with its old value.  Rows are seen as 2n real numbers, since all coefficients are
// real.
#pragma once

#include <vector>

#include "core/matrix.h"

namespace isosyrk {

using Row = Eigen::Map<Eigen::ArrayXd>;
using ConstRow = Eigen::Map<const Eigen::ArrayXd>;

/// Row r of X as 2n real numbers: real and imaginary parts in turn.
inline Row row(Matrix& X, Index r) {
  return {reinterpret_cast<double*>(X.data() + r * X.cols()), 2 * X.cols()};
}
inline ConstRow row(const Matrix& X, Index r) {
  return {reinterpret_cast<const double*>(X.data() + r * X.cols()), 2 * X.cols()};
}

/// sum = coefficient(0) X_0 + ... + coefficient(s-1) X_{s-1}, row r, s >= 1.
/// `coefficients` is any s-vector expression of doubles.
template <class Coefficients, class Out>
void combine_row(const Coefficients& coefficients, const Matrix* X, Index r, Out&& sum) {
  const Index s = coefficients.size();
  // Up to three terms in one pass over the row; the rest is added three at a time.
  switch (s) {
    case 1:
      sum = coefficients(0) * row(X[0], r);
      return;
    case 2:
      sum = coefficients(0) * row(X[0], r) + coefficients(1) * row(X[1], r);
      return;
    default:
      sum = coefficients(0) * row(X[0], r) + coefficients(1) * row(X[1], r) +
            coefficients(2) * row(X[2], r);
      break;
  }
  for (Index j = 3; j < s; ++j) sum += coefficients(j) * row(X[j], r);
}

/// Σ |fresh - old|² over one row.
template <class Fresh, class Old>
double squared_change(const Fresh& fresh, const Old& old) {
  return (fresh - old).square().sum();
}

/// s matrices of size n x n, zero.
inline std::vector<Matrix> stage_matrices(Index s, Index n) {
  return std::vector<Matrix>(static_cast<std::size_t>(s), Matrix::Zero(n, n));
}

}  // namespace isosyrk
