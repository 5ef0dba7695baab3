// Conjugation by an exponential, summed as a series of commutators.
#pragma once

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Computes e^Ω W e^(-Ω) = W + [Ω, W] + [Ω, [Ω, W]]/2 + ... for Ω and W in g, to rounding, without
/// forming the exponential.  Each term takes one product: [Ω, T] = M - J⁻¹ M† J with M = Ω T.  The
/// algebra must outlive the series.
template <class Scalar>
class AdjointSeries {
 public:
  using Stored = MatrixOf<Scalar>;

  explicit AdjointSeries(const QuadraticAlgebra& algebra);

  /// out = e^(scale Ω) W e^(-scale Ω).  The series ends when a term is below rounding relative to
  /// W.  Returns false if 200 terms do not suffice or a term is not finite.  out is not W.
  bool conjugate(ProductsOf<Scalar>& products, double scale, const Stored& Omega, const Stored& W,
                 Stored& out);

  /// out = [A, B] for A, B in g, by one product.  out is neither A nor B.
  void commutator(ProductsOf<Scalar>& products, const Stored& A, const Stored& B, Stored& out);

 private:
  const QuadraticAlgebra& algebra_;
  Stored term_;
  Stored next_;
  Stored product_;
  Stored adjoint_;  // J⁻¹ M† J; empty if J = I
};

}  // namespace isosyrk
