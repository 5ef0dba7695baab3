// Complex matrices in split-complex storage: real and imaginary parts apart, as vector units take them.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Real numbers that one part of a row takes: at least n + 3, padded to whole vectors of 64 bytes, so
/// that four numbers may be read from any column on.  Twice that, the distance from row to row, is
/// never a multiple of 4 KiB, at which all rows would fall into the same sets of a cache.
template <class Real>
Index split_row(Index n) {
  constexpr Index vector = 64 / sizeof(Real);
  const Index row = (n + 3 + vector - 1) / vector * vector;
  return row % (32 * vector) == 0 ? row + vector : row;
}

/// An n x n complex matrix in split-complex storage: each row holds its real parts, then its
/// imaginary parts, both padded with zeros to split_row(n).  So any range of rows is one piece of
/// memory.
template <class Real>
class SplitMatrixOf {
 public:
  using Entries = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  SplitMatrixOf() = default;
  /// All zero.
  explicit SplitMatrixOf(Index n)
      : n_(n),
        stride_(2 * split_row<Real>(n)),
        band_(n - 1),
        entries_(Entries::Zero(n * stride_)) {}

  explicit SplitMatrixOf(const Matrix& W) : SplitMatrixOf(W.rows()) { load(W); }

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

  /// Takes the entries of W; the band is the whole again.
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

using SplitMatrix = SplitMatrixOf<double>;
/// In single precision: for corrections, of which only the leading digits are wanted.
using SingleMatrix = SplitMatrixOf<float>;

/// Matrices of one size, one for each stage or other unknown: what the operations of this room take.
template <class Real>
using SplitStagesOf = std::vector<SplitMatrixOf<Real>>;
using SplitStages = SplitStagesOf<double>;
using SingleStages = SplitStagesOf<float>;

template <class Real = double>
SplitStagesOf<Real> split_stages(Index count, Index n) {
  return SplitStagesOf<Real>(static_cast<std::size_t>(count), SplitMatrixOf<Real>(n));
}

}  // namespace isosyrk
