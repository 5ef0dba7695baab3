// The isospectral midpoint rule: the algebra formulation for the midpoint tableau, in one unknown.
#pragma once

#include "isosyrk/integrators/published_form.h"

namespace isosyrk {

/// Unknown W̃, n x n.  Stage equation and update, with B = B(W̃):
///
///     W̃  = W₀ + (h/2) [B, W̃] + (h²/4) B W̃ B
///     W₁ = W₀ + h [B, W̃]
///
/// [B, W̃] = M - J⁻¹ M† J with M = B W̃.
/// Products: 2 a sweep (M and M B), 1 for the update.  Poisson solves: 1 a sweep, 1 for the update.
/// Source: the paper's ISOSYRK equations at s = 1 with X and K eliminated.
template <class Scalar>
class IsospectralMidpoint final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zero, Form::scratch_of_J;
  using typename Form::Stored;

 public:
  IsospectralMidpoint(SharedFlowIn<Scalar> flow, const IterationOptions& options,
                      ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;

  Stored W_stage_;  // W̃
  Stored B_;
  Stored M_;        // B W̃
  Stored MB_;       // B W̃ B
  Stored adjoint_;  // J⁻¹ M† J; empty if J = I
};

}  // namespace isosyrk
