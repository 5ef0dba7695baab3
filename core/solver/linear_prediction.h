// Prediction of what comes next in a sequence of vectors from what came last.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Takes y_{m+1} for a sum of the last q vectors, with the weights that would have given the newest
/// one best (linear prediction by the covariance method: J. Makhoul, Proc. IEEE 63, 1975, section
/// II.A; here of vectors, and of one value of m alone):
///
///     y_{m+1} ≈ Σ_{j=1..q} c_j y_{m+1-j},   c minimising |y_m - Σ_{j=1..q} c_j y_{m-j}|
///
/// What is a sum of oscillations is predicted as a polynomial of no order can.  Only the products
/// of each new vector with the others are formed, O(q) passes over one.  Nothing allocates but the
/// constructor.
class LinearPrediction {
 public:
  /// The largest q.
  static constexpr int most = 24;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

  /// Of vectors of so many numbers, by at most q others.  Throws std::invalid_argument unless
  /// 0 <= q <= most.
  LinearPrediction(Index numbers, int q);

  /// Where the next vector has to be written to before add().
  Eigen::Ref<RealVector> next() { return vectors_.col(after_newest()); }
  void add();
  void forget() { known_ = 0; }

  /// How many terms can be fitted to the vectors there are: one more is needed, to be predicted.
  int terms() const { return known_ > 0 ? known_ - 1 : 0; }
  /// c_1, ..., c_q with q = terms(); none where they cannot be told.
  Weights weights() const;

 private:
  Index after_newest() const { return (newest_ + 1) % vectors_.cols(); }

  RealMatrix vectors_;  // a ring of q + 1, each a column
  RealMatrix dots_;     // of each with each
  Index newest_ = 0;
  int known_ = 0;
};

}  // namespace isosyrk
