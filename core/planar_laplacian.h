// The inverse Laplacian on planar matrices.
#pragma once

#include <vector>

#include "core/laplacian.h"
#include "core/planar_matrix.h"

namespace isosyrk {

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

 private:
  using Reals = typename PlanarMatrixOf<Real>::Entries;

  Index n_;
  Index stride_;
  // Row i: for the diagonals m = 0 .. n-1-i, at i stride + m; 0 after them.
  Reals lower_;
  Reals reciprocal_pivot_;
  Reals no_factors_;  // of the row below the last
  Reals identity_solution_;
};

using PlanarLaplacian = PlanarLaplacianOf<double>;
using SingleLaplacian = PlanarLaplacianOf<float>;

}  // namespace isosyrk
