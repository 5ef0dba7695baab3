#include "core/planar_products.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "core/planar_blocks.h"

namespace isosyrk {

const std::vector<PlanarKernel>& planar_kernels() {
  static const std::vector<PlanarKernel> all = [] {
    std::vector<PlanarKernel> found;
#if defined(ISOSYRK_KERNEL_AVX512)
    if (__builtin_cpu_supports("avx512f")) found.push_back(planar_kernel_avx512());
#endif
#if defined(ISOSYRK_KERNEL_AVX2)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      found.push_back(planar_kernel_avx2());
    }
#endif
    found.push_back(planar_kernel_portable());
    return found;
  }();
  return all;
}

namespace {

// Where a share begins: above it lies part / parts of all entries, or of those of the upper
// triangle.
Index first_row(Index n, bool upper, Index part, Index parts) {
  const double above = static_cast<double>(part) / static_cast<double>(parts);
  const double share = upper ? 1.0 - std::sqrt(1.0 - above) : above;
  return static_cast<Index>(std::lround(share * static_cast<double>(n)));
}

}  // namespace

PlanarProducts::PlanarProducts(Index n) : PlanarProducts(n, planar_kernels().front()) {}

PlanarProducts::PlanarProducts(Index n, const PlanarKernel& kernel) : n_(n), kernel_(kernel) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  scratch_ = RealVector::Zero(planar_scratch(n, planar_stride(n)));
}

void PlanarProducts::multiply(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                              double scale, Share share) {
  form(A, false, B, C, scale, false, share);
}
void PlanarProducts::multiply_adjoint_left(const PlanarMatrix& A, const PlanarMatrix& B,
                                           PlanarMatrix& C) {
  form(A, true, B, C, 1.0, false, {});
}
void PlanarProducts::multiply_skew(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                                   double scale) {
  multiply_upper(A, B, C, scale);
  mirror_skew(C);
}
void PlanarProducts::multiply_upper(const PlanarMatrix& A, const PlanarMatrix& B, PlanarMatrix& C,
                                    double scale, Share share) {
  form(A, false, B, C, scale, true, share);
}
void PlanarProducts::multiply_adjoint_left_upper(const PlanarMatrix& A, const PlanarMatrix& B,
                                                 PlanarMatrix& C, Share share) {
  form(A, true, B, C, 1.0, true, share);
}

void PlanarProducts::form(const PlanarMatrix& A, bool adjoint, const PlanarMatrix& B,
                          PlanarMatrix& C, double scale, bool upper, Share share) {
  if (A.size() != n_ || B.size() != n_ || C.size() != n_) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {0} x {0}", n_));
  }
  if (&C == &A || &C == &B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  kernel_.multiply({n_, A.stride(), A.re(), A.im(), adjoint, B.re(), B.im(), scale, C.re(), C.im(),
                    upper, first_row(n_, upper, share.part, share.parts),
                    first_row(n_, upper, share.part + 1, share.parts), scratch_.data()});
  if (share.part == 0) ++(upper ? triangles_ : full_);
}

}  // namespace isosyrk
