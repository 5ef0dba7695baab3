// The cotangent formulation in planar matrices, its structure used.
#pragma once

#include "core/fast_form.h"
#include "core/tableau.h"

namespace isosyrk {

/// CotangentForm for J = I: unknowns Q_i, P_i, B_i = B(W̃_i),
///
///     W̃_i = Q_i† P_i, taken as skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     P_i = W₀ - h Σ_j a_ij P_j B_j;             W₁  = Q₁† P₁, likewise with b_j
///
/// Products: 2s and s triangles a sweep, a triangle for the update, which takes Q_j B_j and P_j B_j
/// from the last sweep.  With P_i = W₀ Q_i this is the group form, in as many products.
class FastCotangent final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastCotangent(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void start_cold() override;
  double sweep(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  Tableau tableau_;
  std::vector<PlanarMatrix> W_stage_, B_, QB_, PB_;
  PlanarMatrix Q1_, P1_, identity_;
  RealVector Q_change_, P_change_;
};

}  // namespace isosyrk
