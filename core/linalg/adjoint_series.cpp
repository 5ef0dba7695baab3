#include "isosyrk/linalg/adjoint_series.h"

#include "isosyrk/linalg/operations.h"

namespace isosyrk {

AdjointSeries::AdjointSeries(const QuadraticAlgebra& algebra) : algebra_(algebra) {
  term_ = next_ = product_ = Matrix::Zero(algebra.size(), algebra.size());
  if (!algebra.is_skew_hermitian()) adjoint_ = term_;
}

void AdjointSeries::commutator(Products& products, const Matrix& A, const Matrix& B, Matrix& out) {
  products.multiply(A, B, product_);
  commutator_of_product(algebra_, product_, adjoint_, out);
}

bool AdjointSeries::conjugate(Products& products, double scale, const Matrix& Omega,
                              const Matrix& W, Matrix& out) {
  constexpr int most_terms = 200;
  constexpr double rounding = 1e-17;  // relative to W, in the Frobenius norm
  const double bound = rounding * W.norm();
  out = W;
  term_ = W;
  for (int k = 1; k <= most_terms; ++k) {
    commutator(products, Omega, term_, next_);
    next_ *= scale / static_cast<double>(k);
    out += next_;
    term_.swap(next_);
    const double size = term_.norm();
    if (!std::isfinite(size)) return false;
    if (size <= bound) return true;
  }
  return false;
}

}  // namespace isosyrk
