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
/// Where plain iteration contracts slowly it is the transport Q_j B_j that does, in fine scales
/// which Δ⁻¹ keeps out of B.  So a sweep there transports twice with the same B_j: s products more,
/// and half the sweeps.  The first of the two is the plain sweep whose change the solver bounds,
/// and the only one where it is below the tolerance.
///
/// Products: 2s and s triangles a sweep (3s and s where it transports twice), 1 and a triangle for
/// the update, which takes Q_j B_j from the last sweep.
class FastGroup final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void start_cold() override;
  double sweep(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  double transport(double h);

  Tableau tableau_;
  std::vector<PlanarMatrix> W0Q_, W_stage_, B_, QB_;
  PlanarMatrix Q1_, identity_;
  RealVector change_;
  double tolerance_;
  bool transports_twice_;
};

}  // namespace isosyrk
