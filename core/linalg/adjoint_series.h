// Conjugation by an exponential, summed as a series of commutators.
#pragma once

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// How a sum of AdjointSeries ended.
enum class SeriesEnd {
  summed,
  cancels,  ///< a term was larger than allowed: terms cancel, and the sum would lose digits
  endless,  ///< 200 terms did not suffice, or a term was not finite
};

/// Computes e^Ω W e^(-Ω) and its mean φ₁(ad_Ω) W, φ₁(z) = (e^z - 1)/z, for Ω and W in g, to
/// rounding, without forming the exponential.  Both are sums over the same terms:
///
///     T₀ = W,  T_k = [Ω, T_{k-1}] / k,    e^Ω W e^(-Ω) = Σ T_k,    φ₁(ad_Ω) W = Σ T_k / (k + 1)
///
/// Each term takes one product: [Ω, T] = M - J⁻¹ M† J with M = Ω T.  A sum ends when a term is
/// below rounding relative to W.  The algebra must outlive the series.
template <class Scalar>
class AdjointSeries {
 public:
  using Stored = MatrixOf<Scalar>;

  explicit AdjointSeries(const QuadraticAlgebra& algebra);

  /// out = e^(scale Ω) W e^(-scale Ω).  Returns false if the sum is endless.  out is not W.
  bool conjugate(ProductsOf<Scalar>& products, double scale, const Stored& Omega, const Stored& W,
                 Stored& out);

  /// conjugated = e^(scale Ω) W e^(-scale Ω), mean = φ₁(scale ad_Ω) W.  Ends where ‖T_k‖_F is above
  /// `largest` ‖W‖_F.  Neither is W.
  SeriesEnd sum(ProductsOf<Scalar>& products, double scale, const Stored& Omega, const Stored& W,
                double largest, Stored& conjugated, Stored& mean);

  /// out = [A, B] for A, B in g, by one product.  out is neither A nor B.
  void commutator(ProductsOf<Scalar>& products, const Stored& A, const Stored& B, Stored& out);

 private:
  template <class Add>
  SeriesEnd each_term(ProductsOf<Scalar>& products, double scale, const Stored& Omega,
                      const Stored& W, double largest, const Add& add);

  const QuadraticAlgebra& algebra_;
  Stored term_;
  Stored next_;
  Stored product_;
  Stored adjoint_;  // J⁻¹ M† J; empty if J = I
};

}  // namespace isosyrk
