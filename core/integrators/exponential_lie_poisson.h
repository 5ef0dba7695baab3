// The exponential Lie-Poisson methods: unknowns in the algebra, conjugation by an exponential.
#pragma once

#include "isosyrk/integrators/modified_gradient.h"
#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_rotation.h"

namespace isosyrk {

/// One unknown Ω in g, for flows with J = I.  Equation and update, with φ₁(z) = (e^z - 1)/z:
///
///     Ω  = h B̃(μ),   μ = φ₁(ad_Ω) W₀
///     W₁ = e^Ω W₀ e^(-Ω) = W₀ + [Ω, μ]
///
/// B̃ = ∇F is the gradient of a modified Hamiltonian (integrators/modified_gradient.h): B for order
/// 2, and with terms in h² and h⁴ for orders 4 and 6.  The step is isospectral for any Ω, and
/// Lie-Poisson for any F: the map that hF generates in exponential coordinates.
///
/// A sweep is Ω ← h B̃(φ₁(ad_Ω) W₀) from Ω = 0.  The change of Ω is relative to ‖Ω‖_F, or to more
/// where Ω is less than the rounding of a rotation that B is left without
/// (integrators/unit_of_exponent.h). AdjointRotation sums both series to rounding, so that the
/// spectrum does not depend on the tolerance.  A step diverges if it fails: Ω is far too long then.
/// Products: 0, 3, 12 for order 2, 4, 6 and 1 for each term of the series a sweep; 1 for each term
/// for the update.  Poisson solves: 1, 3, 6 a sweep.
/// Source: generating functions of Ge and Marsden 1988, in the coordinates of Channell and Scovel
/// 1991 (core/integrators/EXPONENTIAL.md).
template <class Scalar>
class ExponentialLiePoisson final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::rotation_left_out, Form::zero;
  using typename Form::Stored;

 public:
  /// order is 2, 4 or 6.  Throws std::invalid_argument for a flow with another J than I, and from
  /// order 4 on for one whose B is not self-adjoint (Flow::has_self_adjoint_generator).  For order
  /// 2 any B may be, and the step is Lie-Poisson if B is the gradient of any H.
  ExponentialLiePoisson(SharedFlowIn<Scalar> flow, int order, const IterationOptions& options,
                        ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;

  int order_;
  double tolerance_;
  AdjointRotation<Scalar> rotation_;
  PublishedLie<Scalar> lie_;
  ModifiedGradient<PublishedLie<Scalar>> gradient_;
  Stored Omega_;
  Stored Omega_next_;
  Stored mu_;
  Stored v_;         // B(μ)
  Stored beyond_v_;  // B̃(μ) - v
  Stored rotated_;   // e^Ω W₀ e^(-Ω) of a sweep, which is not used
};

}  // namespace isosyrk
