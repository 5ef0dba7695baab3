// Complex matrices whose real and imaginary parts stand apart, which is what vector units take.
#pragma once

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/split/share.h"

namespace isosyrk {

/// Real numbers that one part of a row takes: n and at least 3 more, filled up to whole vectors of
/// 64 bytes, so that four may be taken from any column on.  Twice that, from row to row, is never a
/// multiple of 4 KiB, at which all rows would meet in the same sets of a cache.
template <class Real>
Index planar_row(Index n) {
  constexpr Index vector = 64 / sizeof(Real);
  const Index row = (n + 3 + vector - 1) / vector * vector;
  return row % (32 * vector) == 0 ? row + vector : row;
}

/// The rows that a share is of, of n.
struct Rows {
  Rows(Index n, Share share)
      : begin(share.part == 0 ? 0 : n / 2), end(share.part + 1 == share.parts ? n : n / 2) {}
  Index begin;
  Index end;
};

/// An n x n complex matrix, row by row: the real parts of a row, then its imaginary parts.  So a
/// share of the rows is one piece of memory.  What fills the parts up is 0 and stays so.
template <class Real>
class PlanarMatrixOf {
 public:
  using Entries = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  PlanarMatrixOf() = default;
  /// All zero.
  explicit PlanarMatrixOf(Index n)
      : n_(n),
        stride_(2 * planar_row<Real>(n)),
        band_(n - 1),
        entries_(Entries::Zero(n * stride_)) {}

  explicit PlanarMatrixOf(const Matrix& W) : PlanarMatrixOf(W.rows()) { load(W); }

  Index size() const { return n_; }
  /// From row to row.
  Index stride() const { return stride_; }

  /// Entries (r, c) with |r - c| > band are 0, which products make use of: n - 1, the whole, unless
  /// whoever wrote the entries said so.
  Index band() const { return band_; }
  void set_band(Index band) { band_ = band < n_ - 1 ? band : n_ - 1; }

  Real* re() { return entries_.data(); }
  Real* im() { return entries_.data() + stride_ / 2; }
  const Real* re() const { return entries_.data(); }
  const Real* im() const { return entries_.data() + stride_ / 2; }

  /// Everything in a row: for sums of matrices, entry by entry, and for the Frobenius norm.
  Entries& entries() { return entries_; }
  const Entries& entries() const { return entries_; }

  /// Takes the entries of W, or a share of its rows.
  void load(const Matrix& W, Share share = {}) {
    if (share.is_first()) band_ = n_ - 1;
    const Rows rows(n_, share);
    for (Index r = rows.begin; r < rows.end; ++r) {
      for (Index c = 0; c < n_; ++c) {
        re()[r * stride_ + c] = static_cast<Real>(W(r, c).real());
        im()[r * stride_ + c] = static_cast<Real>(W(r, c).imag());
      }
    }
  }
  void store(Matrix& W, Share share = {}) const {
    const Rows rows(n_, share);
    for (Index r = rows.begin; r < rows.end; ++r) {
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

/// The same as places among the entries of X.
struct NumbersOfRows {
  template <class Real>
  NumbersOfRows(const PlanarMatrixOf<Real>& X, Share share)
      : NumbersOfRows(X.stride(), Rows(X.size(), share)) {}
  NumbersOfRows(Index stride, Rows rows) : begin(stride * rows.begin), end(stride * rows.end) {}
  Index begin;
  Index end;
};

using PlanarMatrix = PlanarMatrixOf<double>;
/// In single precision: for corrections of which only the direction and some digits are wanted.
using SingleMatrix = PlanarMatrixOf<float>;

}  // namespace isosyrk
