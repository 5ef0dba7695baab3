#include "isosyrk/split/split_products.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

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

// Returns the number of entries of row (or column) k within a band.
std::int64_t entries_in_band(Index n, Index k, Index band) {
  return std::min(n - 1, k + band) - std::max<Index>(0, k - band) + 1;
}

// Returns the complex multiplications of a product, n³ for full matrices.  Counts the smaller of
// two numbers: pairs of factors within the bands of A and B, and n for each entry of C within
// C_band.
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
SplitProductsOf<Real>::SplitProductsOf(Index n, int threads)
    : SplitProductsOf(n, gemm_kernels().front(), threads) {}

template <class Real>
SplitProductsOf<Real>::SplitProductsOf(Index n, const GemmKernel& kernel, int threads)
    : n_(n), kernel_(kernel) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  scratch_.assign(
      static_cast<std::size_t>(ThreadScope::checked(threads)),
      SplitMatrixOf<Real>::Entries::Zero(gemm_scratch(n, 2 * split_row<Real>(n), n > limits().B)));
}

template <class Real>
const PackingLimits& SplitProductsOf<Real>::limits() const {
  return std::is_same_v<Real, float> ? kernel_.single_limits : kernel_.limits;
}

template <class Real>
void SplitProductsOf<Real>::admit(const ProductOf<Real>& product) {
  if (product.A->size() != n_ || product.B->size() != n_ || product.C->size() != n_) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {0} x {0}", n_));
  }
  if (product.C == product.A || product.C == product.B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  if (parallel::current_threads > static_cast<int>(scratch_.size())) {
    throw std::invalid_argument(fmt::format("product: made for {} threads, called with {}",
                                            scratch_.size(), parallel::current_threads));
  }
  const Index band = product.band < 0 ? n_ - 1 : product.band;
  ++count_;
  half_multiplications_ +=
      (product.upper ? 1 : 2) * multiplications(n_, product.A->band(), product.B->band(), band);
  if (band == n_ - 1) product.C->set_band(product.A->band() + product.B->band());
}

template <class Real>
void SplitProductsOf<Real>::form_share(const ProductOf<Real>& product, Share share, int thread) {
  const SplitProduct<Real> of_kernel = {
      .n = n_,
      .stride = product.A->stride(),
      .A_re = product.A->re(),
      .A_im = product.A->im(),
      .adjoint = product.adjoint,
      .B_re = product.B->re(),
      .B_im = product.B->im(),
      .scale = product.scale,
      .C_re = product.C->re(),
      .C_im = product.C->im(),
      .upper = product.upper,
      .A_band = product.A->band(),
      .B_band = product.B->band(),
      .C_band = product.band < 0 ? n_ - 1 : product.band,
      .first_part = share.first,
      .end_part = share.end,
      .parts = share.parts,
      .packs_B = n_ > limits().B,
      .packs_adjoint_A = n_ > limits().adjoint_A,
      .scratch = scratch_[static_cast<std::size_t>(thread)].data(),
  };
  if constexpr (std::is_same_v<Real, float>) {
    kernel_.multiply_singles(of_kernel);
  } else {
    kernel_.multiply(of_kernel);
  }
}

template class SplitProductsOf<double>;
template class SplitProductsOf<float>;

}  // namespace isosyrk
