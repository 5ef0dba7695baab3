// The cotangent formulation: unknowns on T*G (first row of each block of the paper's Table 1).
#pragma once

#include <vector>

#include "isosyrk/integrators/published_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Unknowns Q_i and P_i, i = 1..s, each n x n.  Stage equations and update:
///
///     W̃_i = Q_i† P_i,   B_i = B(W̃_i)
///     Q_i = I  + h Σ_j a_ij Q_j B_j†,      P_i = W₀ - h Σ_j a_ij P_j B_j
///     Q₁  = I  + h Σ_j b_j Q_j B_j†,       P₁  = W₀ - h Σ_j b_j P_j B_j,      W₁ = Q₁† P₁
///
/// Products: 3s a sweep, 3s + 1 for the update.  Poisson solves: s a sweep, s for the update.
/// Source: the paper's theorem, item 1.  J does not appear, since it acts through B alone.
template <class Scalar>
class CotangentForm final : public ImplicitForm<Scalar> {
  using Form = ImplicitForm<Scalar>;
  using Form::generator, Form::products_, Form::zero, Form::zeros, Form::identity;
  using typename Form::Stages;
  using typename Form::Stored;

 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  CotangentForm(SharedFlowIn<Scalar> flow, const Tableau& tableau, const IterationOptions& options,
                ProductBackend backend);

 private:
  void start(const Stored& W0) override;
  double sweep(const Stored& W0, double h) override;
  void update(const Stored& W0, double h, Stored& W1) override;
  void evaluate_stages();

  Tableau tableau_;
  Stages Q_;
  Stages P_;
  Stages QB_;  // Q_j B_j†
  Stages PB_;  // P_j B_j
  Stored W_stage_;
  Stored B_;
  Stored Q_next_;
  Stored P_next_;
  Stored identity_;
  RealVector change_;  // squared changes of the Q_i, then of the P_i
};

}  // namespace isosyrk
