// Complex matrices in split-complex storage.
#pragma once

#include <vector>

#include "isosyrk/linalg/state_archive.h"
#include "isosyrk/split/parallel.h"

namespace isosyrk {

template <class Real>
class LinearCombination;

/// Returns the length, in numbers, of the real or imaginary part of a row with its padding.  It is
/// at least n + 7, so that 32 bytes may be read from any column on, and a multiple of 64 bytes.
/// The stride, twice this length, is never a multiple of 4 KiB, where all rows would share cache
/// sets.
template <class Real>
Index split_row(Index n) {
  constexpr Index vector = 64 / sizeof(Real);
  const Index row = (n + 7 + vector - 1) / vector * vector;
  return row % (32 * vector) == 0 ? row + vector : row;
}

/// An n x n complex matrix in split-complex storage: each row holds its real parts, then its
/// imaginary parts, both padded with zeros to split_row(n).  A range of rows is therefore
/// contiguous.
template <class Real>
class SplitMatrixOf {
 public:
  using Entries = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  SplitMatrixOf() = default;
  /// The zero matrix.
  explicit SplitMatrixOf(Index n)
      : n_(n),
        stride_(2 * split_row<Real>(n)),
        band_(n - 1),
        entries_(Entries::Zero(n * stride_)) {}

  explicit SplitMatrixOf(const Matrix& W) : SplitMatrixOf(W.rows()) { load(W); }

  /// Forms a linear combination of matrices of this size (split/linear_combination.h).
  SplitMatrixOf& operator=(const LinearCombination<Real>& combination);

  Index size() const { return n_; }
  /// Numbers from row to row.
  Index stride() const { return stride_; }

  /// Returns a band such that all entries with |r - c| > band are 0; products skip these.  It is n
  /// - 1 unless set_band() was called by the function that wrote the entries.
  Index band() const { return band_; }
  void set_band(Index band) { band_ = band < n_ - 1 ? band : n_ - 1; }

  Real* re() { return entries_.data(); }
  Real* im() { return entries_.data() + stride_ / 2; }
  const Real* re() const { return entries_.data(); }
  const Real* im() const { return entries_.data() + stride_ / 2; }

  /// All numbers, padding included, as one vector: for linear combinations and the Frobenius norm.
  Entries& entries() { return entries_; }
  const Entries& entries() const { return entries_; }

  void archive(StateArchive& state) { state.pass(band_, entries_); }

  /// Copies W and resets the band to n - 1.
  template <class Source>
  void load(const Eigen::MatrixBase<Source>& W) {
    band_ = n_ - 1;
    parallel::for_each_block(1, n_, [&](std::size_t, parallel::Rows rows, Index) {
      for (Index r = rows.begin; r < rows.end; ++r) {
        for (Index c = 0; c < n_; ++c) {
          re()[r * stride_ + c] = static_cast<Real>(W(r, c).real());
          im()[r * stride_ + c] = static_cast<Real>(W(r, c).imag());
        }
      }
    });
  }
  /// Copies the entries to W, n x n.
  template <class Target>
  void store(Target&& W) const {
    parallel::for_each_block(1, n_, [&](std::size_t, parallel::Rows rows, Index) {
      for (Index r = rows.begin; r < rows.end; ++r) {
        for (Index c = 0; c < n_; ++c) W(r, c) = {re()[r * stride_ + c], im()[r * stride_ + c]};
      }
    });
  }
  /// Returns the matrix in the usual storage.
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
/// In single precision, for corrections: only their leading digits matter.
using SingleMatrix = SplitMatrixOf<float>;

/// Matrices of one size, one for each stage or pair of stages.
template <class Real>
using SplitStagesOf = std::vector<SplitMatrixOf<Real>>;
using SplitStages = SplitStagesOf<double>;
using SingleStages = SplitStagesOf<float>;

/// Returns the n x n identity, of band 0.
inline SplitMatrix split_identity(Index n) {
  SplitMatrix identity(n);
  for (Index i = 0; i < n; ++i) identity.re()[i * identity.stride() + i] = 1.0;
  identity.set_band(0);
  return identity;
}

/// Returns `count` zero matrices of size n x n.
template <class Real = double>
SplitStagesOf<Real> split_stages(Index count, Index n) {
  return SplitStagesOf<Real>(static_cast<std::size_t>(count), SplitMatrixOf<Real>(n));
}

}  // namespace isosyrk
