// Explicit methods: the Runge-Kutta method of Munthe-Kaas on the group, and as a control the
// classical Runge-Kutta method applied to W.
#pragma once

#include <array>

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_series.h"

namespace isosyrk {

/// RKMK4: the classical Runge-Kutta method in the algebra, with two commutators.  Order 4.
///
///     k₁ = h B(W₀)                               k₂ = h B(Ad(k₁/2) W₀)
///     k₃ = h B(Ad(k₂/2 - [k₁, k₂]/8) W₀)         k₄ = h B(Ad(k₃) W₀)
///     W₁ = Ad(Ω) W₀,   Ω = (k₁ + 2k₂ + 2k₃ + k₄)/6 - [k₁, k₄]/12
///
/// with Ad(Ω)W = e^Ω W e^(-Ω), summed by AdjointSeries to rounding.  Isospectral, not Lie-Poisson.
/// A step diverges if a series does not converge.
/// Products: 2, and 1 for each term of the 4 series.  Poisson solves: 4.
/// Source: Munthe-Kaas 1999; Casas and Owren 2003.
class MuntheKaas4 final : public PublishedForm {
 public:
  MuntheKaas4(const Flow& flow, ProductBackend backend);

 private:
  StepReport take_step(const Matrix& W0, double h, Matrix& W1) override;

  AdjointSeries series_;
  std::array<Matrix, 4> k_;
  Matrix commutator_;
  Matrix Omega_;
  Matrix W_stage_;
};

/// Control: the classical Runge-Kutta method of order 4 applied to W' = [B(W), W].  Neither
/// isospectral nor symmetric.  Unstable for h ‖ad_B‖₂ > 2√2.
/// Products: 4.  Poisson solves: 4.
class ClassicalRungeKutta4 final : public PublishedForm {
 public:
  ClassicalRungeKutta4(const Flow& flow, ProductBackend backend);

 private:
  StepReport take_step(const Matrix& W0, double h, Matrix& W1) override;
  void slope(const Matrix& W, Matrix& out);

  AdjointSeries series_;
  std::array<Matrix, 4> k_;
  Matrix B_;
  Matrix W_stage_;
};

}  // namespace isosyrk
