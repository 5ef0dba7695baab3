#include "isosyrk/split/split_products.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "isosyrk/split/split_blocks.h"

namespace isosyrk {

const std::vector<GemmKernel>& gemm_kernels() {
  static const std::vector<GemmKernel> all = [] {
    std::vector<GemmKernel> found;
#if defined(ISOSYRK_KERNEL_AVX512)
    if (__builtin_cpu_supports("avx512f")) found.push_back(gemm_kernel_avx512());
#endif
#if defined(ISOSYRK_KERNEL_AVX2)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      found.push_back(gemm_kernel_avx2());
    }
#endif
    found.push_back(gemm_kernel_portable());
    return found;
  }();
  return all;
}

namespace {

// How many entries of a row or column k lie in a band.
std::int64_t entries_in_band(Index n, Index k, Index band) {
  return std::min(n - 1, k + band) - std::max<Index>(0, k - band) + 1;
}

// Of the n³ multiplications of a product of full matrices, those whose factors lie in the bands of
// A and B; of two full ones, those within a band of C.
std::int64_t multiplications(Index n, Index A_band, Index B_band, Index C_band) {
  if (A_band == n - 1 && B_band == n - 1 && C_band == n - 1) return n * n * n;
  std::int64_t of_factors = 0;
  std::int64_t of_result = 0;
  for (Index k = 0; k < n; ++k) {
    of_factors += entries_in_band(n, k, A_band) * entries_in_band(n, k, B_band);
    of_result += entries_in_band(n, k, C_band);
  }
  return std::min(of_factors, of_result * n);
}

}  // namespace

template <class Real>
PlanarProductsOf<Real>::PlanarProductsOf(Index n) : PlanarProductsOf(n, gemm_kernels().front()) {}

template <class Real>
PlanarProductsOf<Real>::PlanarProductsOf(Index n, const GemmKernel& kernel)
    : n_(n), kernel_(kernel) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  scratch_ = AnyMatrix::Entries::Zero(gemm_scratch(n, 2 * planar_row<Real>(n), n > limits().B));
}

template <class Real>
void PlanarProductsOf<Real>::multiply(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C,
                                      Real scale, Share share) {
  form(A, false, B, C, scale, false, n_ - 1, share);
  if (share.part == 0) C.set_band(A.band() + B.band());
}
template <class Real>
void PlanarProductsOf<Real>::multiply_adjoint_left(const AnyMatrix& A, const AnyMatrix& B,
                                                   AnyMatrix& C) {
  form(A, true, B, C, 1, false, n_ - 1, {});
  C.set_band(A.band() + B.band());
}
template <class Real>
void PlanarProductsOf<Real>::multiply_adjoint_left_within(Index band, const AnyMatrix& A,
                                                          const AnyMatrix& B, AnyMatrix& C,
                                                          Share share) {
  form(A, true, B, C, 1, false, band, share);
}
template <class Real>
void PlanarProductsOf<Real>::multiply_adjoint_left_upper_within(Index band, const AnyMatrix& A,
                                                                const AnyMatrix& B, AnyMatrix& C,
                                                                Share share) {
  form(A, true, B, C, 1, true, band, share);
}
template <class Real>
void PlanarProductsOf<Real>::multiply_skew(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C,
                                           Real scale) {
  multiply_upper(A, B, C, scale);
  mirror_skew(C);
}
template <class Real>
void PlanarProductsOf<Real>::multiply_upper(const AnyMatrix& A, const AnyMatrix& B, AnyMatrix& C,
                                            Real scale, Share share) {
  form(A, false, B, C, scale, true, n_ - 1, share);
}
template <class Real>
void PlanarProductsOf<Real>::multiply_adjoint_left_upper(const AnyMatrix& A, const AnyMatrix& B,
                                                         AnyMatrix& C, Share share) {
  form(A, true, B, C, 1, true, n_ - 1, share);
}

template <class Real>
void PlanarProductsOf<Real>::form(const AnyMatrix& A, bool adjoint, const AnyMatrix& B,
                                  AnyMatrix& C, Real scale, bool upper, Index band, Share share) {
  if (A.size() != n_ || B.size() != n_ || C.size() != n_) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {0} x {0}", n_));
  }
  if (&C == &A || &C == &B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  const SplitProduct<Real> product = {n_,
                                      A.stride(),
                                      A.re(),
                                      A.im(),
                                      adjoint,
                                      B.re(),
                                      B.im(),
                                      scale,
                                      C.re(),
                                      C.im(),
                                      upper,
                                      A.band(),
                                      B.band(),
                                      band,
                                      share.part,
                                      share.part + 1,
                                      share.parts,
                                      n_ > limits().B,
                                      n_ > limits().adjoint_A,
                                      scratch_.data()};
  if constexpr (std::is_same_v<Real, float>) {
    kernel_.multiply_singles(product);
  } else {
    kernel_.multiply(product);
  }
  if (share.part != 0) return;
  ++(upper ? triangles_ : full_);
  half_multiplications_ += (upper ? 1 : 2) * multiplications(n_, A.band(), B.band(), band);
}

template class PlanarProductsOf<double>;
template class PlanarProductsOf<float>;

}  // namespace isosyrk
