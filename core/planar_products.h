// Products of planar matrices, counted: the planar half of the one place that multiplies.
#pragma once

#include <string_view>
#include <vector>

#include "core/planar_kernel.h"
#include "core/planar_matrix.h"

namespace isosyrk {

/// The kernels that this program was built with and this processor can run, the fastest first.
const std::vector<PlanarKernel>& planar_kernels();

/// A share of the rows of a product that several threads form: `part` of `parts`, from the top.
/// Each entry is summed as in the whole, so that shares put together are the whole bit for bit.
struct Share {
  Index part = 0;
  Index parts = 1;
};

/// Products of n x n planar matrices with one vector unit.  Workspace is allocated once, here; no
/// product allocates.  Not for use by two threads at a time.
class PlanarProducts {
 public:
  /// With the kernel given, or the fastest that runs here.  Throws std::invalid_argument for n < 1.
  explicit PlanarProducts(Index n);
  PlanarProducts(Index n, const PlanarKernel& kernel);

  /// C = scale A B, or a share of it.  All three n x n; C may be neither A nor B
  /// (std::invalid_argument).
  void multiply(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C, double scale = 1.0,
                Share share = {});
  /// C = A† B.
  void multiply_adjoint_left(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C);
  /// C = scale A B, for which it is known that C† = -C: from its upper triangle, so that
  /// it is skew-Hermitian exactly, for little more than half the work.
  void multiply_skew(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                     double scale = 1.0);
  /// The upper triangle of that, and of A† B, or a share of it; below the diagonal anything may be.
  void multiply_upper(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                      double scale = 1.0, Share share = {});
  void multiply_adjoint_left_upper(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                                   Share share = {});

  /// Products since construction; a triangle is one, and so are all shares of a product.
  long count() const { return full_ + triangles_; }
  long triangles() const { return triangles_; }
  /// The same in full products: of a triangle, half is formed.
  double equivalents() const {
    return static_cast<double>(full_) + 0.5 * static_cast<double>(triangles_);
  }
  Index size() const { return n_; }
  std::string_view unit() const { return kernel_.name; }

 private:
  void form(const PlanarMatrix& A, bool adjoint, const PlanarMatrix& B, PlanarMatrix& C,
            double scale, bool upper, Share share);

  Index n_;
  PlanarKernel kernel_;
  RealVector scratch_;
  long full_ = 0;
  long triangles_ = 0;
};

}  // namespace isosyrk
