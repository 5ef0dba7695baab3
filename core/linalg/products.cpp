#include "isosyrk/linalg/products.h"

#include <cblas.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <stdexcept>
#include <type_traits>

namespace isosyrk {

// Calls Eigen's kernel behind `C.noalias() = A * B` with a packing space that is allocated once.
// For large n the expression itself would allocate the space for every product.
template <class Scalar>
struct ProductsOf<Scalar>::EigenWorkspace {
  using Space =
      Eigen::internal::gemm_blocking_space<Eigen::RowMajor, Scalar, Scalar, Eigen::Dynamic,
                                           Eigen::Dynamic, Eigen::Dynamic>;
  explicit EigenWorkspace(Index n) : space(n, n, n, 1, true) { space.allocateAll(); }

  template <int a_order, bool conjugate_a, int b_order, bool conjugate_b>
  void accumulate(Index n, const Scalar* A, const Scalar* B, Scalar* C, double scale) {
    Eigen::internal::general_matrix_matrix_product<Index, Scalar, a_order, conjugate_a, Scalar,
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

template <class Scalar>
ProductsOf<Scalar>::ProductsOf(ProductBackend backend, Index n, Index b)
    : backend_(backend), n_(n), block_(b) {
  if (n < 1) throw std::invalid_argument(fmt::format("products: n = {}, must be at least 1", n));
  if (b < 1 || n % b != 0) {
    throw std::invalid_argument(
        fmt::format("products: blocks of size {}, must divide n = {}", b, n));
  }
  if (backend == ProductBackend::eigen && b == n) workspace_ = std::make_unique<EigenWorkspace>(n);
}

template <class Scalar>
ProductsOf<Scalar>::~ProductsOf() = default;

template <class Scalar>
void ProductsOf<Scalar>::multiply(const Stored& A, const Stored& B, Stored& C, double scale) {
  multiply(Adjoint::none, A, B, C, scale);
}
template <class Scalar>
void ProductsOf<Scalar>::multiply_adjoint_left(const Stored& A, const Stored& B, Stored& C) {
  multiply(Adjoint::left, A, B, C, 1.0);
}
template <class Scalar>
void ProductsOf<Scalar>::multiply_adjoint_right(const Stored& A, const Stored& B, Stored& C) {
  multiply(Adjoint::right, A, B, C, 1.0);
}

template <class Scalar>
void ProductsOf<Scalar>::multiply(Adjoint adjoint, const Stored& A, const Stored& B, Stored& C,
                                  double scale) {
  const auto fits = [this](const Stored& X) { return X.rows() == n_ && X.cols() == block_; };
  if (!fits(A) || !fits(B) || !fits(C)) {
    throw std::invalid_argument(fmt::format("product: every matrix must be {} x {}", n_, block_));
  }
  if (&C == &A || &C == &B) {
    throw std::invalid_argument("product: the result may not be one of the factors");
  }
  ++count_;
  if (block_ == n_) return multiply_dense(adjoint, A, B, C, scale);
  if (block_ == 2) return multiply_blocks<2>(adjoint, A, B, C, scale);
  multiply_blocks<Eigen::Dynamic>(adjoint, A, B, C, scale);
}

template <class Scalar>
void ProductsOf<Scalar>::multiply_dense(Adjoint adjoint, const Stored& A, const Stored& B,
                                        Stored& C, double scale) {
  if (backend_ == ProductBackend::openblas) {
    const int n = static_cast<int>(n_);
    const auto left = adjoint == Adjoint::left ? CblasConjTrans : CblasNoTrans;
    const auto right = adjoint == Adjoint::right ? CblasConjTrans : CblasNoTrans;
    if constexpr (std::is_same_v<Scalar, double>) {
      cblas_dgemm(CblasRowMajor, left, right, n, n, n, scale, A.data(), n, B.data(), n, 0.0,
                  C.data(), n);
    } else {
      const Complex alpha = scale;
      const Complex beta = 0.0;
      cblas_zgemm(CblasRowMajor, left, right, n, n, n, &alpha, A.data(), n, B.data(), n, &beta,
                  C.data(), n);
    }
    return;
  }
  // A row-major matrix read as column-major is its transpose; conjugated, its adjoint.
  constexpr int as_is = Eigen::RowMajor;
  constexpr int transposed = Eigen::ColMajor;
  constexpr bool conjugated = !std::is_same_v<Scalar, double>;
  C.setZero();
  switch (adjoint) {
    case Adjoint::none:
      workspace_->template accumulate<as_is, false, as_is, false>(n_, A.data(), B.data(), C.data(),
                                                                  scale);
      return;
    case Adjoint::left:
      workspace_->template accumulate<transposed, conjugated, as_is, false>(n_, A.data(), B.data(),
                                                                            C.data(), scale);
      return;
    case Adjoint::right:
      workspace_->template accumulate<as_is, false, transposed, conjugated>(n_, A.data(), B.data(),
                                                                            C.data(), scale);
      return;
  }
}

template <class Scalar>
template <int Size>
void ProductsOf<Scalar>::multiply_blocks(Adjoint adjoint, const Stored& A, const Stored& B,
                                         Stored& C, double scale) {
  using Block = Eigen::Matrix<Scalar, Size, Size, Eigen::RowMajor>;
  for (Index first = 0; first < n_; first += block_) {
    const Eigen::Map<const Block> a(A.row(first).data(), block_, block_);
    const Eigen::Map<const Block> b(B.row(first).data(), block_, block_);
    Eigen::Map<Block> c(C.row(first).data(), block_, block_);
    switch (adjoint) {
      case Adjoint::none:
        c = scale * a.lazyProduct(b);
        break;
      case Adjoint::left:
        c = a.adjoint().lazyProduct(b);
        break;
      case Adjoint::right:
        c = a.lazyProduct(b.adjoint());
        break;
    }
  }
}

template class ProductsOf<double>;
template class ProductsOf<Complex>;

}  // namespace isosyrk
