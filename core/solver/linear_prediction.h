// Linear prediction of the next vector of a sequence.
#pragma once

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// Predicts the next vector as a linear combination of the last q, with the weights that fit the
/// newest vector best:
///
///     y_{m+1} ≈ Σ_{j=1..q} c_j y_{m+1-j},   c minimising |y_m - Σ_{j=1..q} c_j y_{m-j}|
///
/// Sums of oscillations are predicted better than by any polynomial.  Each new vector costs its dot
/// products with the q others.  Only the constructor allocates.
/// Source: the covariance method, J. Makhoul, Proc. IEEE 63, 1975, section II.A, here for vectors
/// and for a single m.
class LinearPrediction {
 public:
  /// The largest q.
  static constexpr int most = 24;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

  /// For vectors of length `numbers`, with at most q weights.  Throws std::invalid_argument unless
  /// 0 <= q <= most.
  LinearPrediction(Index numbers, int q);

  /// Returns the place of the next vector.  The caller fills it, then calls add().
  Eigen::Ref<RealVector> next() { return vectors_.col(after_newest()); }
  /// Appends the vector at next() to the sequence.
  void add();
  /// Begins an empty sequence.
  void forget() { known_ = 0; }
  void archive(StateArchive& state) { state.pass(vectors_, dots_, newest_, known_); }

  /// Returns the number of weights that can be fitted: the number of known vectors less one.
  int terms() const { return known_ > 0 ? known_ - 1 : 0; }
  /// Returns c_1, ..., c_q with q = terms(), or an empty vector if the fit fails.
  Weights weights() const;

 private:
  Index after_newest() const { return (newest_ + 1) % vectors_.cols(); }

  RealMatrix vectors_;  // the last q + 1 vectors, a ring of columns
  RealMatrix dots_;     // dot products of all pairs of vectors
  Index newest_ = 0;
  int known_ = 0;
};

}  // namespace isosyrk
