// Conjugation by an exponential, summed as a series of commutators.
#pragma once

#include "isosyrk/linalg/products.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Computes e^Ω W e^(-Ω) and φ₁(ad_Ω) W, φ₁(z) = (e^z - 1)/z, for Ω and W in g, to rounding,
/// without forming the exponential.  Both are sums over the same terms:
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

  /// out = e^(scale Ω) W e^(-scale Ω).  Returns false if 200 terms do not suffice or a term is not
  /// finite.  out is not W.
  bool conjugate(ProductsOf<Scalar>& products, double scale, const Stored& Omega, const Stored& W,
                 Stored& out);

  /// out = φ₁(ad_Ω) W: the mean of e^(sΩ) W e^(-sΩ) over 0 <= s <= 1.  Returns as conjugate().  out
  /// is not W.
  bool average(ProductsOf<Scalar>& products, const Stored& Omega, const Stored& W, Stored& out);

  /// Returns whether the terms of the last sum were at most 1e4 times W.  Larger ones cancel in the
  /// sum, which then has as many times the rounding error of W.
  bool keeps_digits() const { return cancellation_ <= 1e4; }

  /// out = [A, B] for A, B in g, by one product.  out is neither A nor B.
  void commutator(ProductsOf<Scalar>& products, const Stored& A, const Stored& B, Stored& out);

 private:
  template <class Weight>
  bool sum(ProductsOf<Scalar>& products, double scale, const Stored& Omega, const Stored& W,
           const Weight& weight, Stored& out);

  const QuadraticAlgebra& algebra_;
  double cancellation_ = 1.0;  // ‖T_k‖_F / ‖W‖_F of the largest term
  Stored term_;
  Stored next_;
  Stored product_;
  Stored adjoint_;  // J⁻¹ M† J; empty if J = I
};

}  // namespace isosyrk
