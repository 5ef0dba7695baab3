// The quantised Laplacian of Hoppe and Yau on n x n matrices, and its inverse.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The operator ΔW = -Σ_a [S_a, [S_a, W]] with S_a of spin j = (n-1)/2.  Its eigenvalues are
/// -l(l+1), l = 0..n-1.
///
/// Δ maps each diagonal (i, i+m) to itself.  On diagonal m >= 0, of length n-m, -Δ is the real
/// symmetric tridiagonal matrix with
///
///     diagonal(i)      =  2 (j(j+1) - m_i m_{i+m})                                   i = 0..n-m-1
///     off_diagonal(i)  = -sqrt(j(j+1) - m_i(m_i-1)) sqrt(j(j+1) - m_{i+m}(m_{i+m}-1))  (i, i+1)
///
/// so applying and inverting Δ cost O(n²).
class Laplacian {
 public:
  /// Factors every diagonal (L D L^T by LAPACK).  Throws std::invalid_argument for n < 2.
  explicit Laplacian(Index n);

  Index size() const { return n_; }

  /// out = Δ W for any n x n matrix W.
  void apply(const Matrix& W, Matrix& out) const;

  /// P = scale Δ⁻¹ W for skew-Hermitian W.  Reads the upper triangle of W and the imaginary part of
  /// its diagonal.  P is exactly skew-Hermitian, and trace-free to rounding.  The multiple of I in
  /// W, which is not in the range of Δ, is subtracted: stage values are not trace-free.
  /// Allocates nothing.  P is not W.
  void solve_skew_hermitian(const Matrix& W, double scale, Matrix& P) const;

  /// The factors of -Δ = L D Lᵀ on diagonal m, row i.  lower() is l_i in y_i = f_i - l_i y_{i-1}.
  /// reciprocal_pivot() is 1 / d_i, or 0 in the last row of diagonal 0, where the unknown is
  /// pinned to 0.
  double lower(Index i, Index m) const { return lower_[place(i, m)]; }
  double reciprocal_pivot(Index i, Index m) const { return reciprocal_pivot_[place(i, m)]; }
  /// Solution on diagonal 0 for the right-hand side I with scale 1; its last entry is 0.
  const RealVector& identity_solution() const { return identity_solution_; }

  /// Entries of the tridiagonal matrix of -Δ on diagonal m: n-m and n-m-1 numbers.
  static RealVector diagonal(Index n, Index m);
  static RealVector off_diagonal(Index n, Index m);

 private:
  std::size_t place(Index i, Index m) const {
    return static_cast<std::size_t>(row_start_[static_cast<std::size_t>(i)] + 2 * m);
  }

  Index n_;
  // Row i holds lower(i, m), or reciprocal_pivot(i, m), for m = 0..n-1-i.  Each factor stands
  // twice, for the real and the imaginary part, so that a row of complex numbers is one loop over
  // doubles.
  std::vector<double> lower_;
  std::vector<double> reciprocal_pivot_;
  std::vector<Index> row_start_;
  RealVector identity_solution_;
};

}  // namespace isosyrk
