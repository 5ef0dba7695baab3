// What a step or a run costs, counted.
#pragma once

namespace isosyrk {

/// Counted work.
struct Work {
  long products = 0;  ///< n x n complex matrix products; a triangle counts as one
  /// The products in full products in double precision.  A triangle or a product in single
  /// precision counts half; a product of banded matrices counts its multiplications.
  double equivalent_products = 0.0;
  long poisson_solves = 0;  ///< evaluations of the generator B
  /// Projections onto a spectrum, each with all eigenvectors of a matrix beside its products.
  long projections = 0;

  Work& operator+=(const Work& other) {
    products += other.products;
    equivalent_products += other.equivalent_products;
    poisson_solves += other.poisson_solves;
    projections += other.projections;
    return *this;
  }
  Work& operator-=(const Work& other) {
    products -= other.products;
    equivalent_products -= other.equivalent_products;
    poisson_solves -= other.poisson_solves;
    projections -= other.projections;
    return *this;
  }
  friend Work operator+(Work first, const Work& second) { return first += second; }
  friend Work operator-(Work first, const Work& second) { return first -= second; }
  bool operator==(const Work&) const = default;
};

}  // namespace isosyrk
