#include "isosyrk/linalg/adjoint_rotation.h"

namespace isosyrk {

template <class Scalar>
AdjointRotation<Scalar>::AdjointRotation(const QuadraticAlgebra& algebra) : series_(algebra) {
  part_ = mean_of_part_ = algebra.zero<Scalar>();
}

template <class Scalar>
bool AdjointRotation<Scalar>::rotate(ProductsOf<Scalar>& products, const Stored& Omega,
                                     const Stored& W, Stored& rotated, Stored& mean) {
  constexpr int most_parts = 8;
  for (int parts = 1; parts <= most_parts; parts *= 2) {
    const SeriesEnd end = rotate_in(parts, products, Omega, W, rotated, mean);
    if (end != SeriesEnd::cancels) return end == SeriesEnd::summed;
  }
  return false;
}

template <class Scalar>
SeriesEnd AdjointRotation<Scalar>::rotate_in(int parts, ProductsOf<Scalar>& products,
                                             const Stored& Omega, const Stored& W, Stored& rotated,
                                             Stored& mean) {
  constexpr double largest_term = 10.0;
  const double part = 1.0 / parts;
  part_ = W;
  mean.setZero();
  for (int j = 0; j < parts; ++j) {
    const SeriesEnd end =
        series_.sum(products, part, Omega, part_, largest_term, rotated, mean_of_part_);
    if (end != SeriesEnd::summed) return end;
    mean += part * mean_of_part_;
    part_ = rotated;
  }
  return SeriesEnd::summed;
}

template class AdjointRotation<double>;
template class AdjointRotation<Complex>;

}  // namespace isosyrk
