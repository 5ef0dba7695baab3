// Operations on matrices in storage (QuadraticAlgebra) for the published forms: linear combinations
// of stage matrices, commutators from one product, and updates that return the change of an
// unknown.  With the products of products.h and the flow's B, a form needs no access to single
// entries.
//
// Sums over stages cost O(s² n²), products O(s n³).  All coefficients of the sums are real, so a
// matrix is read as its real numbers, 2n² of a dense complex one.  Each operation makes one pass:
// every matrix is read once, and a few numbers of all matrices are combined in registers.
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

/// X_i = base + h Σ_j a_ij Y_j for i = 1..s, and squares[i] = Σ |change of X_i|².  a is s x s with
/// s = Y.size() = X.size() <= max_stages.  No X_i is base or a Y_j.
template <class Scalar>
void update_unknowns(const MatrixOf<Scalar>& base, double h, const RealMatrix& a,
                     const std::vector<MatrixOf<Scalar>>& Y, std::vector<MatrixOf<Scalar>>& X,
                     double* squares);

/// Sets W = W₀ + (S - J⁻¹ Y† J) and returns Σ |change of W|².  With S = Y + Σ_j a_ij K_ij this is
/// the stage vorticity of the algebra formulation.  `scratch` is a matrix if J is not I, and unused
/// otherwise.  W is none of the other arguments.
template <class Scalar>
double update_stage_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                              const MatrixOf<Scalar>& S, const MatrixOf<Scalar>& Y,
                              MatrixOf<Scalar>& scratch, MatrixOf<Scalar>& W);

/// Sets W = W₀ + a (M - J⁻¹ M† J) + b MB and returns Σ |change of W|².  With M = B W̃, a = h/2 and
/// b = h²/4 this is the stage vorticity of the isospectral midpoint rule.  `scratch` as above.  W
/// is none of the other arguments.
template <class Scalar>
double update_midpoint_vorticity(const QuadraticAlgebra& algebra, const MatrixOf<Scalar>& W0,
                                 double a, const MatrixOf<Scalar>& M, double b,
                                 const MatrixOf<Scalar>& MB, MatrixOf<Scalar>& scratch,
                                 MatrixOf<Scalar>& W);

/// out = C - J⁻¹ C† J.  For C = A B with A, B in g this is [A, B].  `scratch` as above.  out is not
/// C.
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
