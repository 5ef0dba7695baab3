// Band truncation: in a smooth state the entries of split matrices decay away from the diagonal.
// Products skip the entries outside a band, where the matrix is negligible.
#pragma once

#include <span>
#include <vector>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Sets the entries of W outside a band to 0, in the rows of the share.
template <class Real>
void cut_to_band(SplitMatrixOf<Real>& W, Index band, Share share = {});
/// Sets W.band(), and what it no longer holds of the band before to 0: the rest is 0 already.
/// Threads take a share each.
template <class Real>
void change_band(SplitMatrixOf<Real>& W, Index band);

/// Sums of squares over each pair of diagonals |r - c| = m of some matrices, m = 0 ... n - 1: from
/// these follows the band for any tail.
using DiagonalSquares = std::vector<RealVector>;
/// Returns zeros for `matrices` n x n matrices.
inline DiagonalSquares diagonal_squares(Index matrices, Index n) {
  return DiagonalSquares(static_cast<std::size_t>(matrices), RealVector::Zero(n));
}

/// Cuts matrices to the smallest band outside which their Frobenius norm is at most a given tail.
/// The band |r - c| <= m holds all modes up to degree m.  In a smooth state bands are therefore
/// narrow; in a rough one nothing is cut.  Only the constructor allocates.
class BandTruncation {
 public:
  /// For up to `matrices` n x n matrices at a time.  If not enabled, nothing is cut.
  BandTruncation(bool enabled, Index matrices, Index n)
      : enabled_(enabled), squares_(diagonal_squares(matrices, n)), cut_bands_(squares_.size()) {}

  bool enabled() const { return enabled_; }
  void enable(bool enabled) { enabled_ = enabled; }

  /// Cuts each X_i to its band and sets X_i.band().  If not enabled, sets the full band.
  template <class Real>
  void truncate(SplitStagesOf<Real>& X, double tail) {
    truncate(std::span(X), {.tail = tail});
  }
  /// The same for one matrix X.
  template <class Real>
  void truncate(SplitMatrixOf<Real>& X, double tail) {
    truncate(std::span(&X, 1), {.tail = tail});
  }
  /// The same for one Hermitian or skew-Hermitian matrix, of which only the upper triangle is
  /// measured.
  template <class Real>
  void truncate_symmetric(SplitMatrixOf<Real>& X, double tail) {
    truncate(std::span(&X, 1), {.tail = tail, .is_symmetric = true});
  }
  /// The same with the tail `part` ‖X‖_F.
  template <class Real>
  void truncate_symmetric_to_part(SplitMatrixOf<Real>& X, double part) {
    truncate(std::span(&X, 1), {.part = part, .is_symmetric = true});
  }
  /// truncate_symmetric that returns the Frobenius norm of X before the cut.
  template <class Real>
  double measure_and_truncate_symmetric(SplitMatrixOf<Real>& X, double tail);

  /// Sets the sums of squares over the diagonals of a Hermitian or skew-Hermitian X, if enabled.
  template <class Real>
  void measure_symmetric(RealVector& squares, const SplitMatrixOf<Real>& X) const;
  /// Returns the smallest band outside which that X has at most the norm `tail`: the full band if
  /// not enabled.
  Index band_of(const RealVector& squares, double tail) const;

  /// Cuts each skew-Hermitian B_i, given by its upper triangle, to its band.  Fills the lower
  /// triangle and sets B_i.band().  Keeps the sums over the diagonals of the uncut B_i in
  /// `squares`, if enabled.
  void truncate_skew(SplitStages& B, DiagonalSquares& squares, double tail) const;
  /// S_i = B_i rounded to single precision and cut to the band of `tail`, with the squares that
  /// truncate_skew has kept for B.
  void round_skew(SingleStages& S, const SplitStages& B, const DiagonalSquares& squares,
                  double tail) const;

 private:
  // Frobenius norm that may be cut: `tail`, and `part` of the norm of the matrix.
  struct Allowed {
    double tail = 0.0;
    double part = 0.0;
    bool is_symmetric = false;  // only upper triangles are measured
  };
  template <class Real>
  void truncate(std::span<SplitMatrixOf<Real>> X, Allowed allowed);

  bool enabled_;
  DiagonalSquares squares_;       // of X in truncate()
  std::vector<Index> cut_bands_;  // that truncate() has found
};

}  // namespace isosyrk
