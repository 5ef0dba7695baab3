// The inverse Laplacian on planar matrices.
#pragma once

#include <vector>

#include "isosyrk/flows/laplacian.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The diagonals m = begin ... end - 1 of an upper triangle, 0 the main one, that a share of those
/// within a band is of: all shares hold about as many entries.
struct Diagonals {
  Diagonals(Index n, Index band, Share share);
  Index begin;
  Index end;
};

/// As Laplacian::solve_skew_hermitian, with the same factors: P = scale Δ⁻¹ W from the upper
/// triangle of W and the imaginary part of its diagonal; P is exactly skew-Hermitian and
/// trace-free.
template <class Real>
class PlanarLaplacianOf {
 public:
  explicit PlanarLaplacianOf(const Laplacian& laplacian);

  /// Allocates nothing.  P is not W.  With a band, only the diagonals of W and P within it count;
  /// the rest of P is 0.
  void solve_skew_hermitian(const PlanarMatrixOf<Real>& W, Real scale, PlanarMatrixOf<Real>& P,
                            Index band) const;
  void solve_skew_hermitian(const PlanarMatrixOf<Real>& W, Real scale,
                            PlanarMatrixOf<Real>& P) const {
    solve_skew_hermitian(W, scale, P, n_ - 1);
  }

  /// The upper triangle of P within the band, or those diagonals of it that a share is of; the
  /// rest of P stays as it was.
  void solve_upper(const PlanarMatrixOf<Real>& W, Real scale, PlanarMatrixOf<Real>& P, Index band,
                   Share share = {}) const;

 private:
  using Reals = typename PlanarMatrixOf<Real>::Entries;

  Index n_;
  Index row_;
  // Row i: for the diagonals m = 0 .. n-1-i, at i row + m; 0 after them.
  Reals lower_;
  Reals reciprocal_pivot_;
  Reals no_factors_;  // of the row below the last
  Reals identity_solution_;
};

using PlanarLaplacian = PlanarLaplacianOf<double>;
using SingleLaplacian = PlanarLaplacianOf<float>;

}  // namespace isosyrk
