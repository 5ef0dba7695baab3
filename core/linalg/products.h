// The one place that multiplies matrices, and counts that it did.
#pragma once

#include <memory>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/product_backend.h"

namespace isosyrk {

/// Floating point operations of one complex n x n product, counted 8 n^3.
double product_flops(Index n);

/// Products of n x n complex matrices with one backend. Workspace is allocated once, here; no
/// product allocates. Not for use by two threads at a time.
class Products {
 public:
  /// Throws std::invalid_argument for n < 1.
  Products(ProductBackend backend, Index n);
  ~Products();
  Products(const Products&) = delete;
  Products& operator=(const Products&) = delete;

  /// C = scale A B.  All three n x n; C may be neither A nor B (std::invalid_argument).
  void multiply(const Matrix& A, const Matrix& B, Matrix& C, double scale = 1.0);
  /// C = A† B.
  void multiply_adjoint_left(const Matrix& A, const Matrix& B, Matrix& C);
  /// C = A B†.
  void multiply_adjoint_right(const Matrix& A, const Matrix& B, Matrix& C);

  /// Products formed since construction.
  long count() const { return count_; }
  ProductBackend backend() const { return backend_; }
  Index size() const { return n_; }

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
