// Band truncation: in a smooth state the entries of split matrices decay away from the diagonal.
// Products skip the entries outside a band, where the matrix is negligible.
#pragma once

#include <vector>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Sets the entries of W outside a band to 0, in the rows of the share.
template <class Real>
void cut_to_band(Index band, SplitMatrixOf<Real>& W, Share share = {});

/// Cuts each matrix to the smallest band outside which its Frobenius norm is at most a given tail.
/// The band |r - c| <= m holds all modes up to degree m.  In a smooth state bands are therefore
/// narrow; in a rough one nothing is cut.  Only the constructor allocates.
class BandTruncation {
 public:
  /// For up to `matrices` n x n matrices at a time.  If not enabled, nothing is cut.
  BandTruncation(bool enabled, std::size_t matrices, Index n);

  bool enabled() const { return enabled_; }
  void enable(bool enabled) { enabled_ = enabled; }

  /// Cuts each X_i to its band and sets X_i.band().  If not enabled, sets the full band.
  template <class Real>
  void truncate(double tail, SplitStagesOf<Real>& X);

  /// Cuts each skew-Hermitian B_i, given by its upper triangle, to its band.  Fills the lower
  /// triangle and sets B_i.band().
  void truncate_skew(double tail, SplitStages& B);
  /// S_i = B_i rounded to single precision and cut to the band of `tail`.  The B_i must be
  /// unchanged since the last truncate_skew().
  void round_skew(double tail, const SplitStages& B, SingleStages& S) const;

 private:
  bool enabled_;
  std::vector<RealVector> squares_;       // diagonal_squares of each X_i in truncate()
  std::vector<RealVector> skew_squares_;  // of each B_i in truncate_skew()
};

}  // namespace isosyrk
