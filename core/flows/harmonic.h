// Quantised spherical harmonics T_lm: eigenvectors of the quantised Laplacian.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The T_lm of size n and one m >= 0, l = m..n-1.  Each is its n-m real entries on the diagonal
/// (i, i+m).  They are the unit eigenvector of -Δ there for the eigenvalue l(l+1), with first entry
/// of sign (-1)^m.  They equal sqrt(2l+1) (-1)^(j-m1) 3j(j l j; -m1 m m2).  T_{l,-m} = (-1)^m
/// T_lm†.
class Harmonics {
 public:
  /// Throws std::invalid_argument unless 0 <= m < n.
  Harmonics(Index n, Index m);

  /// Returns T_lm, valid until the next call.  Throws std::invalid_argument unless m <= l < n.
  const RealVector& operator()(Index l);

 private:
  Index n_;
  Index m_;
  std::vector<long double> off_diagonal_;  // of -Δ, n-m-1 numbers
  std::vector<long double> v_;  // the first half of T_lm, the middle included, up to a factor
  RealVector T_;
};

/// Returns T_lm of size n, m >= 0, as Harmonics(n, m) has it.
/// Throws std::invalid_argument unless 0 <= m <= l < n.
RealVector harmonic(Index n, int l, int m);

/// Returns the coefficients ω_lm = -i <T_lm, W> of a skew-Hermitian W at (l, m), 0 <= m <= l, of an
/// n x n matrix; the entries above are 0:
///
///     W = i Σ_l [ ω_l0 T_l0 + Σ_{m>0} (ω_lm T_lm + conj(ω_lm) T_lm†) ],   ω_l0 real.
///
/// Reads the upper triangle of W and the imaginary part of its diagonal.  Takes O(n³) operations.
Matrix harmonic_coefficients(const Matrix& W);

}  // namespace isosyrk
