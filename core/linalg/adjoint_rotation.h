// Conjugation by an exponential of any size, without loss of digits.
#pragma once

#include "isosyrk/linalg/adjoint_series.h"

namespace isosyrk {

/// Computes e^Ω W e^(-Ω) and φ₁(ad_Ω) W as AdjointSeries does, but in m equal parts of Ω where the
/// terms of a single sum would cancel:
///
///     W_j = e^(Ω/m) W_{j-1} e^(-Ω/m),   e^Ω W e^(-Ω) = W_m,   φ₁(ad_Ω) W = (1/m) Σ φ₁(ad_Ω/m) W_j
///
/// with W₀ = W and j = 0 .. m-1.  m is the least power of two for which no term is above 10 ‖W‖_F,
/// so that less than a digit is lost.  The algebra must outlive the rotation.
template <class Scalar>
class AdjointRotation {
 public:
  using Stored = MatrixOf<Scalar>;

  explicit AdjointRotation(const QuadraticAlgebra& algebra);

  /// Sets `rotated` to e^Ω W e^(-Ω) and `mean` to φ₁(ad_Ω) W.  Returns false if a sum is endless or
  /// 8 parts do not suffice, for an Ω far longer than a step can be.  Neither is W.
  bool rotate(ProductsOf<Scalar>& products, const Stored& Omega, const Stored& W, Stored& rotated,
              Stored& mean);

  /// As AdjointSeries::commutator.
  void commutator(ProductsOf<Scalar>& products, const Stored& A, const Stored& B, Stored& out) {
    series_.commutator(products, A, B, out);
  }

 private:
  SeriesEnd rotate_in(int parts, ProductsOf<Scalar>& products, const Stored& Omega, const Stored& W,
                      Stored& rotated, Stored& mean);

  AdjointSeries<Scalar> series_;
  Stored part_;          // W_j
  Stored mean_of_part_;  // φ₁(ad_Ω/m) W_j
};

}  // namespace isosyrk
