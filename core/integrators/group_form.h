// The group formulation: unknowns on G (second row of each block of the paper's Table 1).
#pragma once

#include <vector>

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Unknowns Q_i, i = 1..s, each n x n.  Stage equations and update:
///
///     W̃_i = Q_i† W₀ J Q_i J⁻¹,   B_i = B(W̃_i)
///     Q_i = I + h Σ_j a_ij Q_j B_j†
///     Q₁  = I + h Σ_j b_j Q_j B_j†,   W₁ = Q₁† W₀ J Q₁ J⁻¹
///
/// Products: 3s a sweep, 3s + 2 for the update.  Poisson solves: s a sweep, s for the update.
/// Source: the paper's theorem, item 3, with Q_k† for the printed Q_k.
template <class Scalar>
class GroupForm final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::algebra, Form::generator, Form::products_, Form::zero, Form::zeros, Form::identity,
      Form::scratch_of_J;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  GroupForm(SharedFlowIn<Scalar> flow, const Tableau& tableau, const IterationOptions& options,
            ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;
  void transport(const Stored& W0, const Stored& Q, Stored& W);
  void evaluate_stages(const Stored& W0);

  Tableau tableau_;
  Stages Q_;
  Stages QB_;  // Q_j B_j†
  Stored W_stage_;
  Stored B_;
  Stored W0Q_;     // W₀ J Q J⁻¹
  Stored JQ_;      // J Q J⁻¹; empty if J = I
  Stored Q_next_;  // Q₁ of the update
  Stored identity_;
  RealVector change_;  // squared changes of the Q_i
};

}  // namespace isosyrk
