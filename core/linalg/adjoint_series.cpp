#include "isosyrk/linalg/adjoint_series.h"

#include "isosyrk/linalg/operations.h"

namespace isosyrk {

template <class Scalar>
AdjointSeries<Scalar>::AdjointSeries(const QuadraticAlgebra& algebra) : algebra_(algebra) {
  term_ = next_ = product_ = algebra.zero<Scalar>();
  if (!algebra.is_skew_hermitian()) adjoint_ = term_;
}

template <class Scalar>
void AdjointSeries<Scalar>::commutator(ProductsOf<Scalar>& products, const Stored& A,
                                       const Stored& B, Stored& out) {
  products.multiply(A, B, product_);
  commutator_of_product(algebra_, product_, adjoint_, out);
}

template <class Scalar>
bool AdjointSeries<Scalar>::conjugate(ProductsOf<Scalar>& products, double scale,
                                      const Stored& Omega, const Stored& W, Stored& out) {
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

template class AdjointSeries<double>;
template class AdjointSeries<Complex>;

}  // namespace isosyrk
