#include "isosyrk/linalg/quadratic_algebra.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

namespace isosyrk {

QuadraticAlgebra::QuadraticAlgebra(Index n, Index b) : n_(n), block_(b) {}

QuadraticAlgebra QuadraticAlgebra::skew_hermitian(Index n, Index b) {
  if (n < 1) throw std::invalid_argument(fmt::format("algebra: n = {}, must be at least 1", n));
  if (b < 1 || n % b != 0) {
    throw std::invalid_argument(
        fmt::format("algebra: blocks of size {}, must divide n = {}", b, n));
  }
  return QuadraticAlgebra(n, b);
}

QuadraticAlgebra::QuadraticAlgebra(const Matrix& J) : n_(J.rows()), block_(J.rows()) {
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
  if (J == Matrix::Identity(n_, n_)) return;
  for (Index i = 0; i < n_; ++i) {
    for (Index j = 0; j < n_; ++j) {
      if (J(i, j) != 0.0) entries_.push_back({i, j, J(i, j)});
    }
  }
  // A factor of modulus 1 is left out if J is real without it.
  const Complex first = entries_.front().value;
  const Complex phase = first / std::abs(first);
  const auto is_real = [&](const Entry& entry) { return (entry.value / phase).imag() == 0.0; };
  real_ = std::all_of(entries_.begin(), entries_.end(), is_real);
  if (!real_) return;
  alpha_ /= phase * phase;
  for (Entry& entry : entries_) entry.value /= phase;
}

template <class Scalar>
void QuadraticAlgebra::pack(const Eigen::Ref<const Matrix>& W, MatrixOf<Scalar>& stored) const {
  if constexpr (std::is_same_v<Scalar, Complex>) {
    if (is_dense()) {
      stored = W;
      return;
    }
  }
  for (Index r = 0; r < n_; ++r) {
    const Index first = r - r % block_;
    for (Index c = 0; c < n_; ++c) {
      const Complex value = W(r, c);
      const bool inside = c >= first && c < first + block_;
      if (!inside && value != 0.0) {
        throw std::invalid_argument(fmt::format(
            "W: entry ({}, {}) is {}{:+}i, must be 0 outside the diagonal blocks of size {}", r, c,
            value.real(), value.imag(), block_));
      }
      if (!inside) continue;
      if constexpr (std::is_same_v<Scalar, double>) {
        if (value.imag() != 0.0) {
          throw std::invalid_argument(fmt::format("W: entry ({}, {}) is {}{:+}i, must be real", r,
                                                  c, value.real(), value.imag()));
        }
        stored(r, c - first) = value.real();
      } else {
        stored(r, c - first) = value;
      }
    }
  }
}

template <class Scalar>
void QuadraticAlgebra::unpack(const MatrixOf<Scalar>& stored, MatrixView W) const {
  if (!is_dense()) W.setZero();
  for (Index first = 0; first < n_; first += block_) {
    W.block(first, first, block_, block_) =
        stored.middleRows(first, block_).template cast<Complex>();
  }
}

namespace {

// A number of J as a factor of matrices.  Factors of a real J are real, which halves the operations
// on complex matrices.
template <class Factor>
Factor as_factor(const Complex& value) {
  if constexpr (std::is_same_v<Factor, double>) {
    return value.real();
  } else {
    return value;
  }
}

}  // namespace

template <class Factor, class Expression, class Scalar>
void QuadraticAlgebra::sum_over_entries(const Expression& Y, MatrixOf<Scalar>& out) const {
  out.setZero();
  for (const Entry& left : entries_) {
    for (const Entry& right : entries_) {
      out(left.row, right.column) += as_factor<Factor>(left.value) * Y(left.column, right.row) *
                                     as_factor<Factor>(right.value);
    }
  }
  out /= as_factor<Factor>(alpha_);
}

template <class Expression, class Scalar>
void QuadraticAlgebra::conjugate(const Expression& Y, MatrixOf<Scalar>& out) const {
  if constexpr (std::is_same_v<Scalar, Complex>) {
    if (!real_) {
      sum_over_entries<Complex>(Y, out);
      return;
    }
  }
  sum_over_entries<double>(Y, out);
}

template <class Scalar>
void QuadraticAlgebra::involution(const MatrixOf<Scalar>& X, MatrixOf<Scalar>& out) const {
  if (is_skew_hermitian()) {
    for (Index first = 0; first < n_; first += block_) {
      out.middleRows(first, block_) = X.middleRows(first, block_).adjoint();
    }
    return;
  }
  conjugate(X.adjoint(), out);
}

template <class Scalar>
void QuadraticAlgebra::project(const MatrixOf<Scalar>& X, MatrixOf<Scalar>& out) const {
  if (!is_skew_hermitian()) {
    involution(X, out);
    out = 0.5 * (X - out);
    return;
  }
  using Eigen::numext::conj;
  for (Index first = 0; first < n_; first += block_) {
    for (Index r = 0; r < block_; ++r) {
      const Scalar diagonal = X(first + r, r);
      out(first + r, r) = 0.5 * (diagonal - conj(diagonal));
      for (Index c = r + 1; c < block_; ++c) {
        out(first + r, c) = X(first + r, c);
        out(first + c, r) = -conj(X(first + r, c));
      }
    }
  }
}

template <class Scalar>
void QuadraticAlgebra::conjugate_by_J(const MatrixOf<Scalar>& Q, MatrixOf<Scalar>& out) const {
  if (is_skew_hermitian()) {
    out = Q;
    return;
  }
  conjugate(Q, out);
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

template void QuadraticAlgebra::pack(const Eigen::Ref<const Matrix>&, MatrixOf<double>&) const;
template void QuadraticAlgebra::pack(const Eigen::Ref<const Matrix>&, Matrix&) const;
template void QuadraticAlgebra::unpack(const MatrixOf<double>&, MatrixView) const;
template void QuadraticAlgebra::unpack(const Matrix&, MatrixView) const;
template void QuadraticAlgebra::involution(const MatrixOf<double>&, MatrixOf<double>&) const;
template void QuadraticAlgebra::involution(const Matrix&, Matrix&) const;
template void QuadraticAlgebra::project(const MatrixOf<double>&, MatrixOf<double>&) const;
template void QuadraticAlgebra::project(const Matrix&, Matrix&) const;
template void QuadraticAlgebra::conjugate_by_J(const MatrixOf<double>&, MatrixOf<double>&) const;
template void QuadraticAlgebra::conjugate_by_J(const Matrix&, Matrix&) const;

}  // namespace isosyrk
