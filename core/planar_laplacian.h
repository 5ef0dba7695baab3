// The inverse Laplacian on planar matrices.
#pragma once

#include <vector>

#include "core/laplacian.h"
#include "core/planar_matrix.h"

namespace isosyrk {

/// As Laplacian::solve_skew_hermitian, with the same factors: P = scale Δ⁻¹ W from the upper
/// triangle of W and the imaginary part of its diagonal; P is exactly skew-Hermitian and
/// trace-free.
class PlanarLaplacian {
 public:
  explicit PlanarLaplacian(const Laplacian& laplacian);

  /// Allocates nothing.  P is not W.
  void solve_skew_hermitian(const PlanarMatrix& W, double scale, PlanarMatrix& P) const;

 private:
  Index n_;
  Index stride_;
  // Row i: for the diagonals m = 0 .. n-1-i, at i stride + m; 0 after them.
  RealVector lower_;
  RealVector reciprocal_pivot_;
  RealVector no_factors_;  // of the row below the last
  RealVector identity_solution_;
};

}  // namespace isosyrk
