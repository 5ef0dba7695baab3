// Products of real and of interleaved complex matrices.  All published forms multiply here, and are
// counted.
#pragma once

#include <memory>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/product_backend.h"

namespace isosyrk {

/// Returns the floating point operations of one complex n x n product, counted as 8 n³.
double product_flops(Index n);

/// Products of n x n matrices with one backend.  Block diagonal matrices are stored as their b x b
/// blocks on top of one another, n x b (QuadraticAlgebra); their blocks are small, and multiplied
/// without a backend.  Only the constructor allocates.  Not for use by two threads at a time.
template <class Scalar>
class ProductsOf {
 public:
  using Stored = MatrixOf<Scalar>;

  /// For dense matrices.  Throws std::invalid_argument for n < 1.
  ProductsOf(ProductBackend backend, Index n) : ProductsOf(backend, n, n) {}
  /// For matrices with blocks of size b.  Throws std::invalid_argument unless b divides n >= 1.
  ProductsOf(ProductBackend backend, Index n, Index b);
  ~ProductsOf();
  ProductsOf(const ProductsOf&) = delete;
  ProductsOf& operator=(const ProductsOf&) = delete;

  /// C = scale A B.  Here and below, throws std::invalid_argument unless A, B and C are n x b and C
  /// is neither A nor B.
  void multiply(const Stored& A, const Stored& B, Stored& C, double scale = 1.0);
  /// C = A† B.
  void multiply_adjoint_left(const Stored& A, const Stored& B, Stored& C);
  /// C = A B†.
  void multiply_adjoint_right(const Stored& A, const Stored& B, Stored& C);

  /// out = A† W B, by two products.  WB becomes W B.  A and B may be one matrix: a congruence.
  void congruence(const Stored& A, const Stored& W, const Stored& B, Stored& WB, Stored& out) {
    multiply(W, B, WB);
    multiply_adjoint_left(A, WB, out);
  }

  /// Returns the number of products since construction.
  long count() const { return count_; }

 private:
  struct EigenWorkspace;
  enum class Adjoint { none, left, right };
  void multiply(Adjoint adjoint, const Stored& A, const Stored& B, Stored& C, double scale);
  void multiply_dense(Adjoint adjoint, const Stored& A, const Stored& B, Stored& C, double scale);
  template <int Size>
  void multiply_blocks(Adjoint adjoint, const Stored& A, const Stored& B, Stored& C, double scale);

  ProductBackend backend_;
  Index n_;
  Index block_;
  long count_ = 0;
  std::unique_ptr<EigenWorkspace> workspace_;
};

using Products = ProductsOf<Complex>;

}  // namespace isosyrk
