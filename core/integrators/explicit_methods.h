// Explicit methods: the Runge-Kutta method of Munthe-Kaas on the group, and Runge-Kutta methods
// applied to W.
#pragma once

#include "isosyrk/integrators/past_slopes.h"
#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_series.h"
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/multistep_schemes.h"

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
template <class Scalar>
class MuntheKaas4 final : public PublishedForm<Scalar> {
  using Form = PublishedForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zero, Form::zeros;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  MuntheKaas4(SharedFlowIn<Scalar> flow, ProductBackend backend);

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) override;

  void form_exponent(std::size_t stage);

  MuntheKaasScheme scheme_;
  AdjointSeries<Scalar> series_;
  Stages k_;           // k_i = h B(Ad(Ω_i) W₀)
  Stored Omega_;       // Ω_i, and at the end Ω
  Stored commutator_;  // of Ω_i
  Stored W_stage_;     // Ad(Ω_i) W₀
};

/// An explicit Runge-Kutta method applied to W' = [B(W), W]: with W_i = W₀ + h Σ_j a_ij k_j,
///
///     k_i = [B(W_i), W_i]     W₁ = W₀ + h Σ_i b_i k_i
///
/// Neither isospectral nor symmetric.  Unstable for h ‖ad_B‖₂ beyond the limit of its scheme.
/// Products: s.  Poisson solves: s.
template <class Scalar>
class ExplicitRungeKutta : public PublishedForm<Scalar> {
  using Form = PublishedForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_;

 public:
  using typename Form::Stages;
  using typename Form::Stored;

  /// Throws std::invalid_argument unless the tableau is consistent and explicit.
  ExplicitRungeKutta(SharedFlowIn<Scalar> flow, const Tableau& tableau, ProductBackend backend);

 protected:
  using Form::zero, Form::zeros;

  StepReport take_step(const Stored& W0, double h, Stored& W1) override;

  /// k = [B(W), W].
  void slope(const Stored& W, Stored& k);
  /// Returns k_1 = [B(W₀), W₀] of the last step.
  const Stored& first_slope() const { return k_[0]; }

 private:
  Tableau tableau_;
  AdjointSeries<Scalar> series_;  // for commutators
  Stages k_;                      // k_i = [B(W_i), W_i]
  Stored B_;                      // B(W_i)
  Stored W_stage_;                // W_i = W₀ + h Σ_j a_ij k_j
};

/// A multistep method applied to W' = [B(W), W]: with f_j = [B(W), W] at the start of the step j
/// steps ago, f₀ at that of this one,
///
///     W̃ = W₀ + h Σ_j β*_j f_j     W₁ = W₀ + h ( β f̃ + Σ_j β_j f_j ),   f̃ = [B(W̃), W̃]
///
/// Until a run has all the past steps that it needs, of one size, a step is one of the method of
/// its start; so is a lone step.  A state that is set or amended, another h, and a step that fails
/// begin the past anew.  Neither isospectral nor symmetric.
/// Products: 2; of a step of the start, those of ExplicitRungeKutta.  Poisson solves: the same.
template <class Scalar>
class AdamsBashforthMoulton final : public ExplicitRungeKutta<Scalar> {
  using Form = ExplicitRungeKutta<Scalar>;
  using Form::first_slope, Form::is_alone, Form::slope, Form::zero, Form::zeros;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws as ExplicitRungeKutta for the tableau of the start.
  AdamsBashforthMoulton(SharedFlowIn<Scalar> flow, const MultistepScheme& scheme,
                        ProductBackend backend);

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) override;
  void forget() override { past_.forget(); }
  void archive_past(StateArchive& run) override { run.pass(past_); }

  MultistepScheme scheme_;
  PastSlopes<Stored> past_;
  Stored predicted_;        // W̃
  Stored predicted_slope_;  // f̃
};

}  // namespace isosyrk
