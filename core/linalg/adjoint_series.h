// Conjugation by an exponential, summed as a series of commutators.
#pragma once

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// e^Ω W e^(-Ω) = W + [Ω, W] + [Ω, [Ω, W]]/2 + ..., for Ω and W in g, to rounding, without forming
/// the exponential.  One product a term: [Ω, T] = M - J⁻¹ M† J with M = Ω T.
class AdjointSeries {
 public:
  explicit AdjointSeries(const QuadraticAlgebra& algebra);

  /// The n x n complex matrices that it holds where J = I.
  static Index matrices() { return 3; }

  /// out = e^(scale Ω) W e^(-scale Ω).  Ends when a term is below rounding relative to W, after at
  /// most 200 terms (false if that was not enough or a term is not finite).  out is not W.
  bool conjugate(Products& products, double scale, const Matrix& Omega, const Matrix& W,
                 Matrix& out);

  /// out = [A, B] for A, B in g: one product.  out is neither A nor B.
  void commutator(Products& products, const Matrix& A, const Matrix& B, Matrix& out);

 private:
  const QuadraticAlgebra& algebra_;
  Matrix term_;
  Matrix next_;
  Matrix product_;
  Matrix adjoint_;  // where J is not I
};

}  // namespace isosyrk
