// Updates that form a commutator from one product, and so stay in the algebra exactly.
#pragma once

#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// out = C - J⁻¹ C† J, which for C = A B with A, B in g is [A, B].  `scratch` is n x n where J is
/// not I, and otherwise not touched.  out is not C.
void commutator_of_product(const QuadraticAlgebra& algebra, const Matrix& C, Matrix& scratch,
                           Matrix& out);

/// out = W₀ + C - J⁻¹ C† J.  For C = Σ w_i B_i W̃_i with B_i, W̃_i in g this is
/// W₀ + Σ w_i [B_i, W̃_i], and in g exactly for J = I: both triangles round alike.
/// `scratch` as above.  out is neither W₀ nor C.
void add_commutator(const QuadraticAlgebra& algebra, const Matrix& W0, const Matrix& C,
                    Matrix& scratch, Matrix& out);

/// X(r, c) = fresh(r, c) for all entries; returns Σ |fresh - X|², the squared change.
template <class Fresh>
double replace(Matrix& X, Fresh&& fresh) {
  double change = 0.0;
  for (Index r = 0; r < X.rows(); ++r) {
    double change_of_row = 0.0;
    for (Index c = 0; c < X.cols(); ++c) {
      const Complex value = fresh(r, c);
      change_of_row += std::norm(value - X(r, c));
      X(r, c) = value;
    }
    change += change_of_row;
  }
  return change;
}

}  // namespace isosyrk
