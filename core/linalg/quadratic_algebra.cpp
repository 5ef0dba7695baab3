#include "isosyrk/linalg/quadratic_algebra.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

QuadraticAlgebra QuadraticAlgebra::skew_hermitian(Index n) {
  if (n < 1) throw std::invalid_argument(fmt::format("algebra: n = {}, must be at least 1", n));
  return QuadraticAlgebra(n);
}

QuadraticAlgebra::QuadraticAlgebra(const Matrix& J) : n_(J.rows()) {
  if (n_ < 1 || J.cols() != n_ || !J.allFinite()) {
    throw std::invalid_argument(
        fmt::format("algebra: J is {} x {}; must be square and finite", J.rows(), J.cols()));
  }
  const Matrix square = J.lazyProduct(J);
  alpha_ = square(0, 0);
  const double defect = (square - alpha_ * Matrix::Identity(n_, n_)).cwiseAbs().maxCoeff();
  if (alpha_ == 0.0 || defect > 1e-14 * std::abs(alpha_)) {
    throw std::invalid_argument("algebra: J must satisfy J^2 = alpha I with alpha != 0");
  }
  for (Index i = 0; i < n_; ++i) {
    for (Index j = 0; j < n_; ++j) {
      if (J(i, j) != 0.0) entries_.push_back({i, j, J(i, j)});
    }
  }
  if (J == Matrix::Identity(n_, n_)) entries_.clear();
}

void QuadraticAlgebra::involution(const Matrix& X, Matrix& out) const {
  if (is_skew_hermitian()) {
    out = X.adjoint();
    return;
  }
  // (J⁻¹ X† J)_ab = sum over entries (a, c) and (d, b) of J_ac conj(X_dc) J_db / alpha.
  out.setZero();
  for (const Entry& left : entries_) {
    for (const Entry& right : entries_) {
      out(left.row, right.column) +=
          left.value * std::conj(X(right.row, left.column)) * right.value / alpha_;
    }
  }
}

void QuadraticAlgebra::conjugate_by_J(const Matrix& Q, Matrix& out) const {
  if (is_skew_hermitian()) {
    out = Q;
    return;
  }
  out.setZero();
  for (const Entry& left : entries_) {
    for (const Entry& right : entries_) {
      out(left.row, right.column) += left.value * Q(left.column, right.row) * right.value / alpha_;
    }
  }
}

Matrix QuadraticAlgebra::dense_J() const {
  if (is_skew_hermitian()) return Matrix::Identity(n_, n_);
  Matrix J = Matrix::Zero(n_, n_);
  for (const Entry& entry : entries_) J(entry.row, entry.column) = entry.value;
  return J;
}

double QuadraticAlgebra::algebra_defect(const Matrix& W) const {
  if (is_skew_hermitian()) return (W + W.adjoint()).cwiseAbs().maxCoeff();
  const Matrix J = dense_J();
  return (W.adjoint().lazyProduct(J) + J.lazyProduct(W)).cwiseAbs().maxCoeff();
}

double QuadraticAlgebra::group_defect(const Matrix& Q) const {
  const Matrix J = dense_J();
  const Matrix JQ = J.lazyProduct(Q);
  return (Q.adjoint().lazyProduct(JQ) - J).cwiseAbs().maxCoeff();
}

}  // namespace isosyrk
