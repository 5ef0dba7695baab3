// Products of planar matrices, counted: the planar half of the one place that multiplies.
#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

#include "isosyrk/split/gemm_kernel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The kernels that this program was built with and this processor can run, the fastest first.
const std::vector<GemmKernel>& gemm_kernels();

/// Products of n x n planar matrices with one vector unit, from what lies in the bands of the
/// factors.  Workspace is allocated once, here; no product allocates.  Not for use by two threads
/// at a time.
template <class Real>
class PlanarProductsOf {
 public:
  using AnyMatrix = PlanarMatrixOf<Real>;

  /// With the kernel given, or the fastest that runs here.  Throws std::invalid_argument for n < 1.
  explicit PlanarProductsOf(Index n);
  PlanarProductsOf(Index n, const GemmKernel& kernel);

  /// C = scale A B, or a share of it, with its band.  All three n x n; C may be neither A nor B
  /// (std::invalid_argument).
  void multiply(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C, Real scale = 1,
                Share share = {});
  /// C = A† B.
  void multiply_adjoint_left(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C);
  /// What of A† B lies within a band, or a share of it; beyond it anything may be.
  void multiply_adjoint_left_within(Index band, const AnyMatrix& A, const AnyMatrix& B,
                                    AnyMatrix& C, Share share = {});
  /// C = scale A B, for which it is known that C† = -C: from its upper triangle, so that
  /// it is skew-Hermitian exactly, for little more than half the work.
  void multiply_skew(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C, Real scale = 1);
  /// The upper triangle of that, and of A† B, or a share of it; below the diagonal anything may be.
  void multiply_upper(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C, Real scale = 1,
                      Share share = {});
  void multiply_adjoint_left_upper(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C,
                                   Share share = {});
  /// What of the upper triangle of A† B lies within a band.
  void multiply_adjoint_left_upper_within(Index band, const AnyMatrix& A, const AnyMatrix& B,
                                          AnyMatrix& C, Share share = {});

  /// Products since construction; a triangle is one, and so are all shares of a product.
  long count() const { return full_ + triangles_; }
  long triangles() const { return triangles_; }
  /// The same in full products, by the multiplications that they take: of a triangle, half is
  /// formed, and where factors have bands less.
  double equivalents() const { return static_cast<double>(half_multiplications_) / (2.0 * cube()); }
  /// Twice the complex multiplications, half of one for each in the whole of a triangle.
  std::int64_t half_multiplications() const { return half_multiplications_; }
  Index size() const { return n_; }
  std::string_view unit() const { return kernel_.name; }

  /// n³.
  double cube() const {
    return static_cast<double>(n_) * static_cast<double>(n_) * static_cast<double>(n_);
  }

 private:
  const PackingLimits& limits() const {
    return std::is_same_v<Real, float> ? kernel_.single_limits : kernel_.limits;
  }
  void form(const AnyMatrix& A, bool adjoint, const AnyMatrix& B, AnyMatrix& C, Real scale,
            bool upper, Index band, Share share);

  Index n_;
  GemmKernel kernel_;
  typename AnyMatrix::Entries scratch_;
  long full_ = 0;
  long triangles_ = 0;
  std::int64_t half_multiplications_ = 0;
};

using PlanarProducts = PlanarProductsOf<double>;
using SingleProducts = PlanarProductsOf<float>;

}  // namespace isosyrk
