// Complex matrices as two planes of real numbers, which is what vector units take.
#pragma once

#include "core/matrix.h"

namespace isosyrk {

/// Doubles from one row of a plane to the next: n and at least 3 more, filled up to whole vectors
/// of 8, so that four may be taken from any column on; and never a multiple of 4 KiB, at which all
/// rows would meet in the same sets of a cache.
inline Index planar_stride(Index n) {
  const Index stride = (n + 3 + 7) / 8 * 8;
  return stride % 512 == 0 ? stride + 8 : stride;
}

/// From where to where one half, 0 or 1, of so many entries reaches: cut between blocks of 8.
struct Half {
  Half(Index size, std::size_t half)
      : begin(half == 0 ? 0 : size / 16 * 8), end(half == 0 ? size / 16 * 8 : size) {}
  Index begin;
  Index end;
};

/// An n x n complex matrix: the plane of real parts, then that of imaginary parts, row by row.
/// What fills the rows up is 0 and stays so.
class PlanarMatrix {
 public:
  PlanarMatrix() = default;
  /// All zero.
  explicit PlanarMatrix(Index n)
      : n_(n), stride_(planar_stride(n)), entries_(RealVector::Zero(2 * n * stride_)) {}

  explicit PlanarMatrix(const Matrix& W) : PlanarMatrix(W.rows()) { load(W); }

  Index size() const { return n_; }
  Index stride() const { return stride_; }

  double* re() { return entries_.data(); }
  double* im() { return entries_.data() + n_ * stride_; }
  const double* re() const { return entries_.data(); }
  const double* im() const { return entries_.data() + n_ * stride_; }

  /// Everything in a row: for sums of matrices, entry by entry, and for the Frobenius norm.
  RealVector& entries() { return entries_; }
  const RealVector& entries() const { return entries_; }

  void load(const Matrix& W) {
    for (Index r = 0; r < n_; ++r) {
      for (Index c = 0; c < n_; ++c) {
        re()[r * stride_ + c] = W(r, c).real();
        im()[r * stride_ + c] = W(r, c).imag();
      }
    }
  }
  void store(Matrix& W) const {
    for (Index r = 0; r < n_; ++r) {
      for (Index c = 0; c < n_; ++c) W(r, c) = {re()[r * stride_ + c], im()[r * stride_ + c]};
    }
  }
  Matrix interleaved() const {
    Matrix W(n_, n_);
    store(W);
    return W;
  }

 private:
  Index n_ = 0;
  Index stride_ = 0;
  RealVector entries_;
};

}  // namespace isosyrk
