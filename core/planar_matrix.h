// Complex matrices as two planes of real numbers, which is what vector units take.
#pragma once

#include "core/matrix.h"

namespace isosyrk {

/// Real numbers from one row of a plane to the next: n and at least 3 more, filled up to whole
/// vectors of 64 bytes, so that four may be taken from any column on; and never a multiple of
/// 4 KiB, at which all rows would meet in the same sets of a cache.
template <class Real>
Index planar_stride(Index n) {
  constexpr Index vector = 64 / sizeof(Real);
  const Index stride = (n + 3 + vector - 1) / vector * vector;
  return stride % (64 * vector) == 0 ? stride + vector : stride;
}

/// From where to where one half, 0 or 1, of so many entries reaches: cut between blocks of 8.
struct Half {
  Half(Index size, std::size_t half)
      : begin(half == 0 ? 0 : size / 16 * 8), end(half == 0 ? size / 16 * 8 : size) {}
  Index begin;
  Index end;
};

/// A share of the work on a matrix that several threads do: `part` of `parts`, from the top.  Each
/// entry is formed as in the whole, so that shares put together are the whole bit for bit.
struct Share {
  Index part = 0;
  Index parts = 1;
};

/// An n x n complex matrix: the plane of real parts, then that of imaginary parts, row by row.
/// What fills the rows up is 0 and stays so.
template <class Real>
class PlanarMatrixOf {
 public:
  using Entries = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  PlanarMatrixOf() = default;
  /// All zero.
  explicit PlanarMatrixOf(Index n)
      : n_(n),
        stride_(planar_stride<Real>(n)),
        band_(n - 1),
        entries_(Entries::Zero(2 * n * stride_)) {}

  explicit PlanarMatrixOf(const Matrix& W) : PlanarMatrixOf(W.rows()) { load(W); }

  Index size() const { return n_; }
  Index stride() const { return stride_; }

  /// Entries (r, c) with |r - c| > band are 0, which products make use of: n - 1, the whole, unless
  /// whoever wrote the entries said so.
  Index band() const { return band_; }
  void set_band(Index band) { band_ = band < n_ - 1 ? band : n_ - 1; }

  Real* re() { return entries_.data(); }
  Real* im() { return entries_.data() + n_ * stride_; }
  const Real* re() const { return entries_.data(); }
  const Real* im() const { return entries_.data() + n_ * stride_; }

  /// Everything in a row: for sums of matrices, entry by entry, and for the Frobenius norm.
  Entries& entries() { return entries_; }
  const Entries& entries() const { return entries_; }

  void load(const Matrix& W) {
    band_ = n_ - 1;
    for (Index r = 0; r < n_; ++r) {
      for (Index c = 0; c < n_; ++c) {
        re()[r * stride_ + c] = static_cast<Real>(W(r, c).real());
        im()[r * stride_ + c] = static_cast<Real>(W(r, c).imag());
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
  Index band_ = -1;
  Entries entries_;
};

using PlanarMatrix = PlanarMatrixOf<double>;
/// In single precision: for corrections of which only the direction and some digits are wanted.
using SingleMatrix = PlanarMatrixOf<float>;

}  // namespace isosyrk
