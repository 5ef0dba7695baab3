// Explicit Magnus methods: conjugation by the exponential of a truncated Magnus series.
#pragma once

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_rotation.h"
#include "isosyrk/tableaux/explicit_tableaux.h"

namespace isosyrk {

/// What both methods share, for flows with J = I.  The classical Runge-Kutta method applied to W
/// gives B at later times, the method Ω from it, and the step is
///
///     W₁ = e^Ω W₀ e^(-Ω),
///
/// summed by AdjointRotation to rounding.  Isospectral, not Lie-Poisson.  A step diverges if that
/// fails: Ω is far too long then.
///
/// D_i is the derivative of B along the flow.  It is B([B_i, W_i]) for a flow whose kind() says
/// that B is linear.  For any other flow D_i is formed by differences of B, in 4 evaluations.
/// Source: Calvo, Iserles and Zanna 1997; Casas and Iserles 2006.
template <class Scalar>
class ExplicitMagnus : public PublishedForm<Scalar> {
  using Form = PublishedForm<Scalar>;

 protected:
  using Form::algebra, Form::generator, Form::products_, Form::zero;
  using typename Form::Stored;

  ExplicitMagnus(SharedFlowIn<Scalar> flow, std::string_view name, ProductBackend backend);

  /// A point of the step: W, B = B(W), k = [B, W], and D, the derivative of B along k.
  struct Point {
    Stored W, B, k, D;
  };
  Point point() const { return {zero(), zero(), zero(), zero()}; }

  /// Sets Ω from W₀.
  virtual void form_Omega(const Stored& W0, double h) = 0;

  /// Sets the point with this W.
  void evaluate_at(const Stored& W, Point& point);
  /// Sets W to that of the classical Runge-Kutta step of h from a point.
  void predict(const Point& from, double h, Stored& W);
  void bracket(const Stored& A, const Stored& B, Stored& out) {
    rotation_.commutator(products_, A, B, out);
  }

  Stored Omega_;

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) final;
  void differentiate(Point& point);

  AdjointRotation<Scalar> rotation_;
  bool is_linear_;
  Tableau tableau_;        // of the Runge-Kutta step
  std::vector<Stored> k_;  // its slopes
  Stored B_stage_, W_stage_;
};

/// Order 4:
///
///     a₀ = (h/2) (B₀ + B₁) + (h²/12) (D₀ - D₁)
///     a₁ = (h/10) (B₁ - B₀) - (h²/120) (D₀ + D₁)
///     Ω  = a₀ - [a₀, a₁]
///
/// with 0 at W₀ and 1 at the end of a Runge-Kutta step.
/// Products: 6, and 1 for each term of the series.  Poisson solves: 7.
template <class Scalar>
class ExplicitMagnus4 final : public ExplicitMagnus<Scalar> {
  using Form = ExplicitMagnus<Scalar>;
  using Form::bracket, Form::evaluate_at, Form::predict, Form::Omega_;
  using typename Form::Point;
  using typename Form::Stored;

 public:
  ExplicitMagnus4(SharedFlowIn<Scalar> flow, ProductBackend backend);

 private:
  void form_Omega(const Stored& W0, double h) override;

  Point start_, end_;
  Stored a0_, a1_;
};

/// Order 5, with b_i = B_i and d_i = h D_i at the start, the middle m and the end of two
/// Runge-Kutta steps of h/2:
///
///     m₀ = h (7 b₀/30 + 8 b_m/15 + 7 b₁/30 + d₀/60 - d₁/60)
///     m₁ = h ((b₁ - b₀)/14 - d₀/280 + 2 d_m/105 - d₁/280)
///     m₂ = h (9 b₀/280 + 2 b_m/105 + 9 b₁/280 + d₀/560 - d₁/560)
///     α₂ = 12 m₁,   α₃ = 180 (m₂ - m₀/12),   α₁ = m₀ - α₃/12
///     C₁ = [α₁, α₂],   C₂ = -[α₁, 2 α₃ + C₁]/60
///     Ω  = α₁ + α₃/12 + [-20 α₁ - α₃ + C₁, α₂ + C₂]/240
///
/// Products: 12, and 1 for each term of the series.  Poisson solves: 12.
template <class Scalar>
class ExplicitMagnus5 final : public ExplicitMagnus<Scalar> {
  using Form = ExplicitMagnus<Scalar>;
  using Form::bracket, Form::evaluate_at, Form::predict, Form::Omega_;
  using typename Form::Point;
  using typename Form::Stored;

 public:
  ExplicitMagnus5(SharedFlowIn<Scalar> flow, ProductBackend backend);

 private:
  void form_Omega(const Stored& W0, double h) override;

  Point start_, middle_, end_;
  Stored m0_, m1_, m2_;
  Stored alpha1_, alpha2_, alpha3_;
  Stored C1_, C2_;
  Stored left_, right_;  // of a bracket
};

}  // namespace isosyrk
