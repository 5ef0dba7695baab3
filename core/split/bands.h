// Band truncation: split matrices of a smooth state fall off away from the diagonal, and products
// leave out what does not count.
#pragma once

#include <vector>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The smallest band outside which entries come to at most `tail` in the Frobenius norm, from the
/// sums of squares of the diagonals |r - c| = 0 ... n - 1.
Index smallest_band(const RealVector& squares, double tail);

/// Sets what lies outside a band of W to 0, or the share of the rows.
template <class Real>
void cut_to_band(Index band, SplitMatrixOf<Real>& W, Share share = {});

/// The policy of band truncation, with its workspace: each matrix is cut to the smallest band that
/// holds all but a tail of it in the Frobenius norm.  |r - c| <= m holds all modes up to degree m, so
/// in a smooth state bands are narrow; in a rough one nothing is cut.  Allocates in the constructor
/// only.
class BandTruncation {
 public:
  /// For up to `matrices` n x n matrices at a time; if not enabled, nothing is ever cut.
  BandTruncation(bool enabled, std::size_t matrices, Index n);

  bool enabled() const { return enabled_; }
  void enable(bool enabled) { enabled_ = enabled; }

  /// Cuts each X_i to its band, and says so (SplitMatrixOf::band).
  template <class Real>
  void truncate(double tail, SplitStagesOf<Real>& X);

  /// B_i, skew-Hermitian, of which the upper triangle is given: the lower one is filled in, and both
  /// are cut.
  void truncate_skew(double tail, SplitStages& B);
  /// S_i = B_i rounded to single precision, cut to what counts against `tail`; B_i as
  /// truncate_skew left them last.
  void round_skew(double tail, const SplitStages& B, SingleStages& S) const;

 private:
  bool enabled_;
  std::vector<RealVector> squares_;  // of the diagonals of what truncate() measured
  std::vector<RealVector> skew_squares_;
};

}  // namespace isosyrk
