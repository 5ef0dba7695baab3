// Control: an implicit Runge-Kutta method applied directly to W' = [B(W), W].
#pragma once

#include <vector>

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Unknowns W̃_i, i = 1..s, each n x n.  Stage equations and update, with B_i = B(W̃_i):
///
///     W̃_i = W₀ + h Σ_j a_ij [B_j, W̃_j],     W₁ = W₀ + h Σ_j b_j [B_j, W̃_j]
///
/// Products: s a sweep, s for the update.  Poisson solves: s a sweep, s for the update.
/// Not isospectral: symplectic tableaux keep the quadratic Casimir tr W² and lose tr W³.  W stays
/// in g.  The three formulations are compared against this control.
template <class Scalar>
class DirectForm final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zero, Form::zeros,
      Form::scratch_of_J;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  DirectForm(SharedFlowIn<Scalar> flow, const Tableau& tableau, const IterationOptions& options,
             ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;
  void evaluate_stages();
  template <class Weights>
  void add_increment(const Stored& W0, const Weights& weights, Stored& out);

  Tableau tableau_;
  Stages W_stage_;
  Stages C_;  // B_i W̃_i
  Stored B_;
  Stored sum_;    // Σ_j weights_j C_j
  Stored fresh_;  // the new W̃_i
  RealVector change_;
  Stored scratch_;  // J⁻¹ C† J; empty if J = I
};

}  // namespace isosyrk
