// Operations on matrices in storage (QuadraticAlgebra): linear combinations, changes, and
// commutators from one product.  All coefficients of the sums are real, so a matrix is read as its
// real numbers, 2n² of a dense complex one.
#pragma once

#include <type_traits>
#include <vector>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Returns a view of the real numbers of X, in storage order.
template <class Scalar>
Eigen::Map<Eigen::ArrayXd> reals(MatrixOf<Scalar>& X) {
  return {reinterpret_cast<double*>(X.data()), X.size() * (std::is_same_v<Scalar, double> ? 1 : 2)};
}
template <class Scalar>
Eigen::Map<const Eigen::ArrayXd> reals(const MatrixOf<Scalar>& X) {
  return {reinterpret_cast<const double*>(X.data()),
          X.size() * (std::is_same_v<Scalar, double> ? 1 : 2)};
}

namespace operations {

/// Calls set(sum) once, where `sum` is an expression for the first terms weights(j) Y_j, at most
/// three.  `set` evaluates the expression in one pass.  Further terms are added to out one at a
/// time.
template <class Weights, class Scalar, class Set>
void combine(const Weights& weights, const std::vector<MatrixOf<Scalar>>& Y, MatrixOf<Scalar>& out,
             Set&& set) {
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
template <class Weights, class Scalar>
void combine(const Weights& weights, const std::vector<MatrixOf<Scalar>>& Y,
             MatrixOf<Scalar>& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = sum; });
}

/// out = base + Σ_j weights(j) Y_j with at least one term.  out is neither base nor a Y_j.
template <class Weights, class Scalar>
void combine(const MatrixOf<Scalar>& base, const Weights& weights,
             const std::vector<MatrixOf<Scalar>>& Y, MatrixOf<Scalar>& out) {
  operations::combine(weights, Y, out, [&](const auto& sum) { reals(out) = reals(base) + sum; });
}

/// Returns Σ |fresh - old|² over all entries.
template <class Scalar>
double squared_change(const MatrixOf<Scalar>& fresh, const MatrixOf<Scalar>& old) {
  return (reals(fresh) - reals(old)).square().sum();
}

/// Returns the largest change of several unknowns, given the squares of their changes.  NaN if any
/// square is NaN.
inline double largest_change(const RealVector& squares) {
  double largest = 0.0;
  for (const double square : squares) largest = larger(largest, square);
  return std::sqrt(largest);
}

/// The entries of Y†, of a matrix in storage, which is not formed.  Y must outlive it.
template <class Scalar>
class AdjointOf {
 public:
  explicit AdjointOf(const MatrixOf<Scalar>& Y) : Y_(Y) {}
  Scalar operator()(Index r, Index c) const {
    const Index first = r - r % Y_.cols();  // row of the block
    return Eigen::numext::conj(Y_(first + c, r - first));
  }

 private:
  const MatrixOf<Scalar>& Y_;
};

/// out = C - J⁻¹ C† J.  For C = A B with A, B in g this is [A, B].  `scratch` is a matrix if J is
/// not I, and unused otherwise.  out is not C.
template <class Scalar>
void commutator_of_product(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& C,
                           MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& out);

/// out = W₀ + C - J⁻¹ C† J.  For C = Σ w_i B_i W̃_i with B_i, W̃_i in g this is
/// W₀ + Σ w_i [B_i, W̃_i].  For J = I the result is in g exactly if W₀ is, since both triangles
/// round alike.  `scratch` as above.  out is neither W₀ nor C.
template <class Scalar>
void add_commutator(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                    const MatrixOf<Scalar>& C, MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& out);

}  // namespace isosyrk
