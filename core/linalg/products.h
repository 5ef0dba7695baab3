// Products of interleaved complex matrices.  All published forms multiply here, and are counted.
#pragma once

#include <memory>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/product_backend.h"

namespace isosyrk {

/// Returns the floating point operations of one complex n x n product, counted as 8 n³.
double product_flops(Index n);

/// Products of n x n complex matrices with one backend.  Only the constructor allocates.  Not for
/// use by two threads at a time.
class Products {
 public:
  /// Throws std::invalid_argument for n < 1.
  Products(ProductBackend backend, Index n);
  ~Products();
  Products(const Products&) = delete;
  Products& operator=(const Products&) = delete;

  /// C = scale A B.  Here and below, throws std::invalid_argument unless A, B and C are n x n and C
  /// is neither A nor B.
  void multiply(const Matrix& A, const Matrix& B, Matrix& C, double scale = 1.0);
  /// C = A† B.
  void multiply_adjoint_left(const Matrix& A, const Matrix& B, Matrix& C);
  /// C = A B†.
  void multiply_adjoint_right(const Matrix& A, const Matrix& B, Matrix& C);

  /// Returns the number of products since construction.
  long count() const { return count_; }

 private:
  struct EigenWorkspace;
  enum class Adjoint { none, left, right };
  void multiply(Adjoint adjoint, const Matrix& A, const Matrix& B, Matrix& C, double scale);

  ProductBackend backend_;
  Index n_;
  long count_ = 0;
  std::unique_ptr<EigenWorkspace> workspace_;
};

}  // namespace isosyrk
