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

// out = Σ weight(k) T_k.
template <class Scalar>
template <class Weight>
bool AdjointSeries<Scalar>::sum(ProductsOf<Scalar>& products, double scale, const Stored& Omega,
                                const Stored& W, const Weight& weight, Stored& out) {
  constexpr int most_terms = 200;
  constexpr double rounding = 1e-17;  // relative to W, in the Frobenius norm
  const double size_of_W = W.norm();
  double largest = size_of_W;
  bool summed = false;
  out = W;
  term_ = W;
  for (int k = 1; k <= most_terms && !summed && std::isfinite(largest); ++k) {
    commutator(products, Omega, term_, next_);
    next_ *= scale / static_cast<double>(k);
    out += weight(k) * next_;
    term_.swap(next_);
    const double size = term_.norm();
    largest = larger(largest, size);
    summed = size <= rounding * size_of_W;
  }
  cancellation_ = size_of_W == 0.0 ? 1.0 : largest / size_of_W;
  return summed;
}

template <class Scalar>
bool AdjointSeries<Scalar>::conjugate(ProductsOf<Scalar>& products, double scale,
                                      const Stored& Omega, const Stored& W, Stored& out) {
  return sum(
      products, scale, Omega, W, [](int) { return 1.0; }, out);
}

template <class Scalar>
bool AdjointSeries<Scalar>::average(ProductsOf<Scalar>& products, const Stored& Omega,
                                    const Stored& W, Stored& out) {
  return sum(
      products, 1.0, Omega, W, [](int k) { return 1.0 / (k + 1.0); }, out);
}

template class AdjointSeries<double>;
template class AdjointSeries<Complex>;

}  // namespace isosyrk
