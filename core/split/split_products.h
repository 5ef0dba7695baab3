// Products of split matrices, counted: the one place that multiplies in split-complex storage.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "isosyrk/split/gemm_kernel.h"
#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The kernels that this program was built with and this processor can run, the fastest first.
const std::vector<GemmKernel>& gemm_kernels();

/// One product C = scale A B, or scale A† B: n x n matrices, C neither A nor B.  What it leaves out is
/// said by the functions below; beyond that anything may stand in C.
template <class Real>
struct ProductOf {
  const SplitMatrixOf<Real>* A;
  const SplitMatrixOf<Real>* B;
  SplitMatrixOf<Real>* C;
  Real scale = 1;
  bool adjoint = false;  ///< A† in place of A
  bool upper = false;    ///< only the upper triangle of C is formed
  Index band = -1;       ///< only |r - c| <= band of C is formed; -1 for all

  /// Only the upper triangle, for C known to be skew-Hermitian: little more than half the work.
  ProductOf upper_triangle() const {
    ProductOf product = *this;
    product.upper = true;
    return product;
  }
  /// Only what lies within a band.
  ProductOf within(Index of_C) const {
    ProductOf product = *this;
    product.band = of_C;
    return product;
  }
};

/// C = scale A B.
template <class Real>
ProductOf<Real> times(const SplitMatrixOf<Real>& A, const SplitMatrixOf<Real>& B,
                      SplitMatrixOf<Real>& C, std::type_identity_t<Real> scale = 1) {
  return {&A, &B, &C, scale};
}
/// C = A† B.
template <class Real>
ProductOf<Real> adjoint_times(const SplitMatrixOf<Real>& A, const SplitMatrixOf<Real>& B,
                              SplitMatrixOf<Real>& C) {
  return {&A, &B, &C, 1, true};
}

/// Products of n x n split matrices with one vector unit, from what lies in the bands of the factors.
/// Workspace is allocated once, here; no product allocates.  Several products at a time share the
/// threads of the ThreadScope.  Not for use by two callers at a time.
template <class Real>
class SplitProductsOf {
 public:
  /// For up to so many threads, with the kernel given or the fastest that runs here.  Throws
  /// std::invalid_argument for n < 1.
  explicit SplitProductsOf(Index n, int threads = 1);
  SplitProductsOf(Index n, const GemmKernel& kernel, int threads = 1);

  /// Forms product(i) for i = 0 ... count - 1; none may read what another writes.  Sets the band of
  /// each C that is formed whole.  Throws std::invalid_argument for a matrix of another size, a C
  /// that is one of its factors, or more threads than it was made for.
  template <class Product>
  void form(std::size_t count, Product&& product) {
    for (std::size_t i = 0; i < count; ++i) note(product(i));
    parallel::for_each_share(
        static_cast<Index>(count),
        [&](Index i) { return Index{product(static_cast<std::size_t>(i)).upper ? 1 : 2}; },
        [&](Index i, Share share, int thread) {
          form_share(product(static_cast<std::size_t>(i)), share, thread);
        });
  }
  void form(const ProductOf<Real>& product) {
    form(1, [&](std::size_t) { return product; });
  }

  /// Products since construction; a triangle is one.
  long count() const { return count_; }
  /// The same in full products, by the multiplications that they take: of a triangle, half is
  /// formed, and where factors have bands less.
  double equivalents() const { return static_cast<double>(half_multiplications_) / (2.0 * cube()); }
  Index size() const { return n_; }

 private:
  double cube() const {
    return static_cast<double>(n_) * static_cast<double>(n_) * static_cast<double>(n_);
  }
  const PackingLimits& limits() const;
  void note(const ProductOf<Real>& product);
  void form_share(const ProductOf<Real>& product, Share share, int thread);

  Index n_;
  GemmKernel kernel_;
  std::vector<typename SplitMatrixOf<Real>::Entries> scratch_;  // one a thread
  long count_ = 0;
  std::int64_t half_multiplications_ = 0;  // twice the complex multiplications
};

using SplitProducts = SplitProductsOf<double>;
using SingleProducts = SplitProductsOf<float>;

}  // namespace isosyrk
