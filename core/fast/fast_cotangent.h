// The cotangent formulation in planar matrices, its structure used.
#pragma once

#include "isosyrk/fast/fast_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// CotangentForm for J = I: unknowns Q_i, P_i, B_i = B(W̃_i),
///
///     W̃_i = Q_i† P_i, taken as skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     P_i = W₀ - h Σ_j a_ij P_j B_j;             W₁  = Q₁† P₁, likewise with b_j
///
/// and of corrections δ_i to Q_i and ε_i to P_i
///
///     (T δ)_i = -h Σ_j a_ij δ_j B_j,   (K δ)_i = -h Σ_j a_ij Q_j B(N_j),   N_j = δ_j† P_j + Q_j†
///     ε_j
///
/// and alike for ε with P_j.
/// Products: 2s and s triangles a sweep, a triangle for the update, which takes Q_j B_j and P_j B_j
/// from the last sweep; in single precision 2s for T and 4s for K, both within bands.  Q_i and P_i
/// are cut to their bands.  With P_i = W₀ Q_i this is the group form, in as many products.
class FastCotangent final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastCotangent(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void start_cold() override;
  void begin() override;
  double sweep(double h) override;
  double residual(double h) override;
  Index linearise(double h, double accuracy) override;
  double transport(double h) override;
  double couple(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  void transport_stages();

  Tableau tableau_;
  std::vector<PlanarMatrix> W_stage_, B_, QB_, PB_;
  PlanarMatrix Q1_, P1_, identity_;
  Singles Q_single_, P_single_, B_single_, N_, N_of_P_, dB_, Q_product_, P_product_;
};

}  // namespace isosyrk
