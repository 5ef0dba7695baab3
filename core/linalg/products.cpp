#include "isosyrk/linalg/products.h"

#include <cblas.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <stdexcept>

namespace isosyrk {

// Calls Eigen's kernel behind `C.noalias() = A * B` with a packing space that is allocated once.
// For large n the expression itself would allocate the space for every product.
struct Products::EigenWorkspace {
  using Space =
      Eigen::internal::gemm_blocking_space<Eigen::RowMajor, Complex, Complex, Eigen::Dynamic,
                                           Eigen::Dynamic, Eigen::Dynamic>;
  explicit EigenWorkspace(Index n) : space(n, n, n, 1, true) { space.allocateAll(); }

  template <int a_order, bool conjugate_a, int b_order, bool conjugate_b>
  void accumulate(Index n, const Complex* A, const Complex* B, Complex* C, double scale) {
    Eigen::internal::general_matrix_matrix_product<Index, Complex, a_order, conjugate_a, Complex,
                                                   b_order, conjugate_b, Eigen::RowMajor,
                                                   1>::run(n, n, n, A, n, B, n, C, 1, n, scale,
                                                           space, nullptr);
  }

  Space space;
};

const std::vector<ProductBackend>& product_backends() {
  static const std::vector<ProductBackend> all = {ProductBackend::openblas, ProductBackend::eigen};
  return all;
}

std::string_view name(ProductBackend backend) {
  return backend == ProductBackend::openblas ? "openblas" : "eigen";
}

double product_flops(Index n) {
  const double m = static_cast<double>(n);
  return 8.0 * m * m * m;
}

Products::Products(ProductBackend backend, Index n) : backend_(backend), n_(n) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  if (backend == ProductBackend::eigen) workspace_ = std::make_unique<EigenWorkspace>(n);
}

Products::~Products() = default;

void Products::multiply(const Matrix& A, const Matrix& B, Matrix& C, double scale) {
  multiply(Adjoint::none, A, B, C, scale);
}
void Products::multiply_adjoint_left(const Matrix& A, const Matrix& B, Matrix& C) {
  multiply(Adjoint::left, A, B, C, 1.0);
}
void Products::multiply_adjoint_right(const Matrix& A, const Matrix& B, Matrix& C) {
  multiply(Adjoint::right, A, B, C, 1.0);
}

void Products::multiply(Adjoint adjoint, const Matrix& A, const Matrix& B, Matrix& C,
                        double scale) {
  const auto square = [this](const Matrix& X) { return X.rows() == n_ && X.cols() == n_; };
  if (!square(A) || !square(B) || !square(C)) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {0} x {0}", n_));
  }
  if (&C == &A || &C == &B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  ++count_;
  if (backend_ == ProductBackend::openblas) {
    const Complex alpha = scale;
    const Complex beta = 0.0;
    const int n = static_cast<int>(n_);
    cblas_zgemm(CblasRowMajor, adjoint == Adjoint::left ? CblasConjTrans : CblasNoTrans,
                adjoint == Adjoint::right ? CblasConjTrans : CblasNoTrans, n, n, n, &alpha,
                A.data(), n, B.data(), n, &beta, C.data(), n);
    return;
  }
  // A row-major matrix read as column-major is its transpose; conjugated, its adjoint.
  constexpr int as_is = Eigen::RowMajor;
  constexpr int transposed = Eigen::ColMajor;
  C.setZero();
  switch (adjoint) {
    case Adjoint::none:
      workspace_->accumulate<as_is, false, as_is, false>(n_, A.data(), B.data(), C.data(), scale);
      return;
    case Adjoint::left:
      workspace_->accumulate<transposed, true, as_is, false>(n_, A.data(), B.data(), C.data(),
                                                             scale);
      return;
    case Adjoint::right:
      workspace_->accumulate<as_is, false, transposed, true>(n_, A.data(), B.data(), C.data(),
                                                             scale);
      return;
  }
}

}  // namespace isosyrk
