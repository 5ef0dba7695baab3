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
class DirectForm final : public ImplicitForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  DirectForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
             ProductBackend backend);

 private:
  void start(const Matrix& W0) override;
  double sweep(const Matrix& W0, double h) override;
  void update(const Matrix& W0, double h, Matrix& W1) override;
  void evaluate_stages();
  template <class Weights>
  void add_increment(const Matrix& W0, const Weights& weights, Matrix& out);

  Tableau tableau_;
  std::vector<Matrix> W_stage_;
  std::vector<Matrix> C_;  // B_i W̃_i
  Matrix B_;
  Matrix sum_;    // Σ_j weights_j C_j
  Matrix fresh_;  // the new W̃_i
  RealVector change_;
  Matrix scratch_;  // J⁻¹ C† J; empty if J = I
};

}  // namespace isosyrk
