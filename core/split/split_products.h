// Products of split matrices, counted.  All fast forms multiply here.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "isosyrk/split/gemm_kernel.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Returns the kernels that this program was built with and this processor can run, widest vector
/// unit first.
const std::vector<GemmKernel>& gemm_kernels();

/// The expression scale A B or scale A† B.  Holds pointers to the factors.
template <class Real>
struct Factors {
  double scale;
  const SplitMatrixOf<Real>* A;
  const SplitMatrixOf<Real>* B;
  bool adjoint;  ///< A† in place of A
};

/// A† as the left factor of a product.
template <class Real>
struct Adjoint {
  const SplitMatrixOf<Real>* A;
};
template <class Real>
Adjoint<Real> adjoint(const SplitMatrixOf<Real>& A) {
  return {&A};
}

// A B, (scale A) B, A† B and scale (A B).
template <class Real>
Factors<Real> operator*(const SplitMatrixOf<Real>& A, const SplitMatrixOf<Real>& B) {
  return {1.0, &A, &B, false};
}
template <class Real>
Factors<Real> operator*(const Multiple<Real>& A, const SplitMatrixOf<Real>& B) {
  return {A.weight, A.X, &B, false};
}
template <class Real>
Factors<Real> operator*(const Adjoint<Real>& A, const SplitMatrixOf<Real>& B) {
  return {1.0, A.A, &B, true};
}
template <class Real>
Factors<Real> operator*(double scale, Factors<Real> product) {
  product.scale *= scale;
  return product;
}

/// The product C = scale A B or C = scale A† B of n x n matrices, C neither A nor B.  If only a
/// part of C is formed, the entries outside that part are unspecified.
template <class Real>
struct ProductOf {
  SplitMatrixOf<Real>* C;
  const SplitMatrixOf<Real>* A;
  const SplitMatrixOf<Real>* B;
  Real scale = 1;
  bool adjoint = false;  ///< A† in place of A
  bool upper = false;    ///< only the upper triangle of C is formed
  Index band = -1;       ///< only |r - c| <= band of C is formed; -1 for all

  /// Returns the same product with only the upper triangle of C formed, for skew-Hermitian C.
  /// Takes little more than half the work.
  ProductOf upper_triangle() const {
    ProductOf product = *this;
    product.upper = true;
    return product;
  }
  /// Returns the same product with only |r - c| <= of_C of C formed.
  ProductOf within(Index of_C) const {
    ProductOf product = *this;
    product.band = of_C;
    return product;
  }
};

/// Returns the product that forms C = A B, for SplitProductsOf::form.
template <class Real>
ProductOf<Real> into(SplitMatrixOf<Real>& C, const Factors<Real>& product) {
  return {.C = &C,
          .A = product.A,
          .B = product.B,
          .scale = static_cast<Real>(product.scale),
          .adjoint = product.adjoint};
}

/// Forms products of n x n split matrices with the kernel of one vector unit, skipping entries
/// outside the bands of the factors.  Only the constructor allocates.  Products formed together
/// share the threads of on_threads.  Not for use by two callers at a time.
template <class Real>
class SplitProductsOf {
 public:
  /// For up to `threads` threads, with the given kernel or gemm_kernels().front().  Throws
  /// std::invalid_argument unless n >= 1 and 1 <= threads <= most_threads.
  explicit SplitProductsOf(Index n, int threads = 1);
  SplitProductsOf(Index n, const GemmKernel& kernel, int threads = 1);

  /// Forms product(i) for i = 0 ... count - 1.  No product may read a matrix that another writes.
  /// Sets C.band() unless the product has a band of its own.  Throws std::invalid_argument for a
  /// matrix that is not n x n, a C that is one of its factors, or more threads than the constructor
  /// allowed.
  template <class Product>
  void form(std::size_t count, Product&& product) {
    for (std::size_t i = 0; i < count; ++i) admit(product(i));
    for (std::size_t i = 0; i < count; ++i) form_admitted(product(i));
  }
  void form(const ProductOf<Real>& product) {
    form(1, [&](std::size_t) { return product; });
  }

  /// Returns the number of products since construction; a triangle counts as one.
  long count() const { return count_; }
  /// Returns the work since construction in full products, by complex multiplications.  A triangle
  /// counts half; a product of banded factors counts the multiplications within the bands.
  double equivalents() const {
    return static_cast<double>(half_multiplications_) / static_cast<double>(2 * n_ * n_ * n_);
  }
  Index size() const { return n_; }
  /// Passes both counts to an archive, or goes on from counts that are read.
  void archive(StateArchive& counts) { counts.pass(count_, half_multiplications_); }

 private:
  // Refuses what cannot be formed, counts the product, and sets the band of C.
  void admit(const ProductOf<Real>& product);
  void form_admitted(const ProductOf<Real>& product);

  Index n_;
  GemmFunctions<Real> kernel_;
  typename SplitMatrixOf<Real>::Entries packed_B_;              // empty if B is read in place
  std::vector<typename SplitMatrixOf<Real>::Entries> scratch_;  // one for each thread
  long count_ = 0;
  std::int64_t half_multiplications_ = 0;  // twice the complex multiplications
};

using SplitProducts = SplitProductsOf<double>;
using SingleProducts = SplitProductsOf<float>;

}  // namespace isosyrk
