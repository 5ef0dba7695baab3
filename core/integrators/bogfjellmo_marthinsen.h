// The symplectic Lie group methods of Munthe-Kaas type of Bogfjellmo and Marthinsen, on the
// algebra.
#pragma once

#include <vector>

#include "isosyrk/integrators/composition.h"
#include "isosyrk/integrators/published_form.h"
#include "isosyrk/linalg/adjoint_rotation.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Unknowns v_i and μ_i in g for s stages, for flows with J = I.  With a tableau (a, b),
/// Ω_i = h Σ_j a_ij v_j, Ω = h Σ_j b_j v_j, φ₁(z) = (e^z - 1)/z and φ, its series cut after z^K:
///
///     φ(ad_{Ω_i}) v_i = B(μ_i)
///     φ(-ad_{Ω_j}) μ_j + (h/b_j) Σ_i b_i a_ij D_i*(μ_i) = λ,   λ = φ₁(ad_Ω) W₀
///     W₁ = e^Ω W₀ e^(-Ω)
///
/// where D_i* is the adjoint of δΩ ↦ δ φ(ad_Ω) v_i at Ω_i,
///
///     D_i*(μ) = Σ_{p+q<K} [ad_{Ω_i}^q v_i, (-ad_{Ω_i})^p μ] / (p+q+2)!.
///
/// K = p - 2 is enough for the order p of a symplectic tableau.  Isospectral for any Ω; Lie-Poisson
/// for any tableau, any K and any B = ∇H, linear or not
/// (core/integrators/BOGFJELLMO_MARTHINSEN.md).  With one stage it is the exponential method of
/// order 2.  Symmetric for one stage only, since Ω_i is measured from one end.
///
/// A sweep sets all μ_j, and then all v_i by the new μ_i, from v = B(W₀) and μ = W₀.  The changes
/// of μ_j are in units of the scale, those of h v_i relative to ‖h v_i‖ or to more, as those of Ω
/// for ExponentialLiePoisson.  λ and W₁ are summed to rounding, so that the spectrum does not
/// depend on the tolerance.  A step diverges if that fails.
/// Products: 3 K s and 1 for each term of the series of λ a sweep; 1 for each term for the update.
/// Poisson solves: s a sweep, and 1.
/// Source: Bogfjellmo and Marthinsen, High-order symplectic partitioned Lie group methods, Found.
/// Comput. Math. 16 (2016).
template <class Scalar>
class BogfjellmoMarthinsen final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::rotation_left_out, Form::zero,
      Form::zeros;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for an inconsistent tableau or one with a b_i = 0, and for a flow
  /// with another J than I.
  BogfjellmoMarthinsen(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                       const IterationOptions& options, ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;

  void form_stage(std::size_t i, double h);

  Tableau tableau_;
  int terms_;  // K
  double tolerance_;
  AdjointRotation<Scalar> rotation_;
  Stages v_;                    // v_i
  Stages mu_;                   // μ_i
  Stages xi_;                   // φ(ad_{Ω_i}) v_i
  Stages pulled_;               // φ(-ad_{Ω_i}) μ_i
  Stages D_;                    // D_i*(μ_i)
  Stages of_v_;                 // ad_{Ω_i}^q v_i, q = 0 ... K
  Stages of_mu_;                // (-ad_{Ω_i})^p μ_i, p = 0 ... K
  Stored Omega_, Omega_stage_;  // Ω, Ω_i
  Stored lambda_;               // λ
  Stored rotated_;              // e^Ω W₀ e^(-Ω) of a sweep, which is not used
  Stored sum_, bracket_;        // of D_i*
  Stored next_;                 // the new μ_j or v_i
};

/// Their method of Crouch-Grossman type, W₁ = e^{Ω_s} ... e^{Ω_1} W₀ e^{-Ω_1} ... e^{-Ω_s}, for
/// flows with J = I.  On the algebra it is the composition of exponential steps of order 2 with its
/// weights b for fractions, whatever its a_ij
/// (core/integrators/BOGFJELLMO_MARTHINSEN.md, section 5).
/// Isospectral, Lie-Poisson and symmetric, for any B = ∇H.
template <class Scalar>
class CrouchGrossman final : public Composition<Scalar> {
 public:
  /// Throws as Composition, and for a flow with another J than I.
  CrouchGrossman(SharedFlowIn<Scalar> flow, const CompositionScheme& weights,
                 const IterationOptions& options, ProductBackend backend);
};

}  // namespace isosyrk
