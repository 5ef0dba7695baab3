// Explicit Magnus methods: conjugation by the exponential of a truncated Magnus series.
#pragma once

#include "isosyrk/integrators/magnus_exponent.h"
#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_rotation.h"

namespace isosyrk {

/// PublishedLie with the derivative of B along the flow: B(k) for a flow whose kind() says that B
/// is linear, and otherwise by differences of B, in 4 evaluations.
template <class Scalar>
class LieAlongFlow : public PublishedLie<Scalar> {
 public:
  using typename PublishedLie<Scalar>::M;
  using typename PublishedLie<Scalar>::GeneratorFunction;

  /// As PublishedLie.
  LieAlongFlow(const QuadraticAlgebra& algebra, AdjointRotation<Scalar>& rotation,
               ProductsOf<Scalar>& products, bool is_linear, GeneratorFunction generator);

  void differentiate(M& D, const M& W, const M& k);

 private:
  bool is_linear_;
  M W_shifted_, B_shifted_;  // empty for a linear B
};

/// W₁ = e^Ω W₀ e^(-Ω), summed by AdjointRotation to rounding, with the Ω of MagnusExponent, for
/// flows with J = I.  Isospectral, not Lie-Poisson.  A step diverges if the sum fails: Ω is far too
/// long then.
/// Products: 6 for magnus4() and 12 for magnus5(), and 1 for each term of the series.  Poisson
/// solves: 7 and 12.
/// Source: that of the scheme (tableaux/magnus_schemes.h).
template <class Scalar>
class ExplicitMagnus final : public PublishedForm<Scalar> {
  using Form = PublishedForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zero;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for a flow with another J than I.
  ExplicitMagnus(SharedFlowIn<Scalar> flow, const MagnusScheme& scheme, ProductBackend backend);

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) override;

  AdjointRotation<Scalar> rotation_;
  LieAlongFlow<Scalar> lie_;
  MagnusExponent<LieAlongFlow<Scalar>> exponent_;
  Stored Omega_;
  Stored mean_;  // of AdjointRotation, which is not used
};

}  // namespace isosyrk
