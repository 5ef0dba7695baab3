// The group formulation in planar matrices, its structure used.
#pragma once

#include "core/fast_form.h"
#include "core/tableau.h"

namespace isosyrk {

/// GroupForm for J = I: unknowns Q_i, B_i = B(W̃_i),
///
///     W̃_i = Q_i† (W₀ Q_i), skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     Q₁  = I - h Σ_j b_j Q_j B_j;            W₁  = Q₁† (W₀ Q₁)
///
/// Products: 2s and s triangles a sweep, 1 and a triangle for the update, which takes Q_j B_j from
/// the last sweep.
class FastGroup final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void start_cold() override;
  double sweep(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  void transport(const PlanarMatrix& Q, PlanarMatrix& W);

  Tableau tableau_;
  std::vector<PlanarMatrix> QB_;
  PlanarMatrix W0Q_, W_stage_, B_, Q1_, identity_;
  RealVector change_;
};

}  // namespace isosyrk
