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

// True if a packed B of so many numbers is near.  Where 24 rows share each panel of it, and not a
// tile's 6, products in double take 3 % more time at n = 129 and 257, where B has 0.3 and 1.1 MB,
// and 9 % less at n = 513, where it has 4.3 MB (one thread, caches of 0.5 and 8 MB).
template <class Real>
bool is_near(Index of_B) {
  constexpr Index most_bytes = 1'500'000;
  return of_B * static_cast<Index>(sizeof(Real)) <= most_bytes;
}

// Columns of B that are packed as a block.
constexpr Index columns_of_block = 64;
// Rows of C that are formed as a block.  Enough blocks that a thread that takes the last one makes
// few others wait; more rows where B would not stay in the caches that threads share, because it is
// read for every block.
Index rows_of_block(Index n) {
  constexpr Index largest_cached = 640;
  return n <= largest_cached ? rows_together / 2 : rows_together;
}

// The kernels in one precision.
template <class Real>
const GemmFunctions<Real>& functions(const GemmKernel& kernel) {
  if constexpr (std::is_same_v<Real, float>) {
    return kernel.singles;
  } else {
    return kernel.doubles;
  }
}

}  // namespace

template <class Real>
SplitProductsOf<Real>::SplitProductsOf(Index n, int threads)
    : SplitProductsOf(n, gemm_kernels().front(), threads) {}

template <class Real>
SplitProductsOf<Real>::SplitProductsOf(Index n, const GemmKernel& kernel, int threads)
    : n_(n), kernel_(functions<Real>(kernel)) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  const Index stride = 2 * split_row<Real>(n);
  if (n > kernel_.limits.B) packed_B_.setZero(n * stride);
  scratch_.assign(static_cast<std::size_t>(checked_threads(threads)),
                  SplitMatrixOf<Real>::Entries::Zero(gemm_scratch(n, stride)));
}

template <class Real>
void SplitProductsOf<Real>::admit(const ProductOf<Real>& product) {
  if (product.A->size() != n_ || product.B->size() != n_ || product.C->size() != n_) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {0} x {0}", n_));
  }
  if (product.C == product.A || product.C == product.B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  if (parallel::current_threads() > static_cast<int>(scratch_.size())) {
    throw std::invalid_argument(fmt::format("product: made for {} threads, called with {}",
                                            scratch_.size(), parallel::current_threads()));
  }
  const Index band = product.band < 0 ? n_ - 1 : product.band;
  ++count_;
  half_multiplications_ +=
      (product.upper ? 1 : 2) * multiplications(n_, product.A->band(), product.B->band(), band);
  if (band == n_ - 1) product.C->set_band(product.A->band() + product.B->band());
}

template <class Real>
void SplitProductsOf<Real>::form_admitted(const ProductOf<Real>& product) {
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
      .packed_B = packed_B_.size() > 0 ? packed_B_.data() : nullptr,
      .packs_adjoint_A = n_ > kernel_.limits.adjoint_A,
      .is_B_near = is_near<Real>(packed_B_.size()),
  };
  const bool is_alone = parallel::current_threads() == 1;
  const auto blocks = [&](Index length) { return is_alone ? 1 : (n_ + length - 1) / length; };
  if (of_kernel.packed_B != nullptr) {
    const Index parts = blocks(columns_of_block);
    parallel::for_blocks(parts, [&](Index k, int) {
      kernel_.pack(of_kernel, n_ * k / parts, n_ * (k + 1) / parts);
    });
  }
  const Index parts = blocks(rows_of_block(n_));
  parallel::for_blocks(parts, [&](Index k, int thread) {
    kernel_.form(of_kernel, n_ * k / parts, n_ * (k + 1) / parts,
                 scratch_[static_cast<std::size_t>(thread)].data());
  });
}

template class SplitProductsOf<double>;
template class SplitProductsOf<float>;

}  // namespace isosyrk
