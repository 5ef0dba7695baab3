#include "isosyrk/linalg/adjoint_series.h"

#include <limits>

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

// Calls add(k, T_k) for k = 1, 2, ...
template <class Scalar>
template <class Add>
SeriesEnd AdjointSeries<Scalar>::each_term(ProductsOf<Scalar>& products, double scale,
                                           const Stored& Omega, const Stored& W, double largest,
                                           const Add& add) {
  constexpr int most_terms = 200;
  constexpr double rounding = 1e-17;  // relative to W, in the Frobenius norm
  const double size_of_W = W.norm();
  term_ = W;
  for (int k = 1; k <= most_terms; ++k) {
    commutator(products, Omega, term_, next_);
    next_ *= scale / static_cast<double>(k);
    term_.swap(next_);
    add(k, term_);
    const double size = term_.norm();
    if (!std::isfinite(size)) return SeriesEnd::endless;
    if (size <= rounding * size_of_W) return SeriesEnd::summed;
    if (size > largest * size_of_W) return SeriesEnd::cancels;
  }
  return SeriesEnd::endless;
}

template <class Scalar>
bool AdjointSeries<Scalar>::conjugate(ProductsOf<Scalar>& products, double scale,
                                      const Stored& Omega, const Stored& W, Stored& out) {
  constexpr double any = std::numeric_limits<double>::infinity();
  out = W;
  const auto add = [&](int, const Stored& term) { out += term; };
  return each_term(products, scale, Omega, W, any, add) == SeriesEnd::summed;
}

template <class Scalar>
SeriesEnd AdjointSeries<Scalar>::sum(ProductsOf<Scalar>& products, double scale,
                                     const Stored& Omega, const Stored& W, double largest,
                                     Stored& conjugated, Stored& mean) {
  conjugated = mean = W;
  const auto add = [&](int k, const Stored& term) {
    conjugated += term;
    mean += (1.0 / (k + 1.0)) * term;
  };
  return each_term(products, scale, Omega, W, largest, add);
}

template class AdjointSeries<double>;
template class AdjointSeries<Complex>;

}  // namespace isosyrk
