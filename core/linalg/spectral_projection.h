// Projection of skew-Hermitian matrices onto those with a given spectrum.
#pragma once

#include <vector>

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Replaces the eigenvalues of an n x n skew-Hermitian matrix and keeps its eigenvectors: the
/// nearest matrix with these eigenvalues, in the Frobenius norm.  A block diagonal matrix is
/// projected block by block.  Only the constructor allocates.
class SpectralProjection {
 public:
  /// Products of n x n matrices that a projection takes.
  static constexpr int products = 3;

  /// For matrices of an algebra with J = I.
  SpectralProjection(const QuadraticAlgebra& algebra, ProductBackend backend);

  /// Sets `eigenvalues`, n numbers, to those of -iW, ascending within each block.  Returns false if
  /// W is not finite or LAPACK's zheevr fails; the eigenvalues are then NaN.
  bool find_spectrum(const Matrix& W, RealVector& eigenvalues);

  /// Replaces W = U (iΛ) U† by U (iΛ₀) U† with these eigenvalues, n numbers as find_spectrum orders
  /// them.  The result is skew-Hermitian exactly.  Returns as find_spectrum; W is of no use where
  /// that is false.
  bool project(const RealVector& eigenvalues, Matrix& W);
  /// Returns ‖Λ - Λ₀‖_F of the last project(): how far W was moved.
  double distance() const { return distance_; }

 private:
  bool decompose(const Matrix& W, Index at, bool vectors);
  void make_unitary();

  Index block_;
  Products products_;
  Matrix hermitian_;  // -iW of a block
  Matrix rows_;       // R: its eigenvectors, one a row, -iW = R† Λ R
  Matrix scratch_;
  Matrix product_;
  RealVector values_;  // Λ
  double distance_ = 0.0;
  // Of LAPACK's zheevr.  zheevd is as fast, but its products of small matrices allocate.
  std::vector<Complex> work_;
  std::vector<double> real_work_;
  std::vector<int> integer_work_, support_;
};

}  // namespace isosyrk
