// The group formulation in planar matrices, its structure used.
#pragma once

#include "isosyrk/fast/fast_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// GroupForm for J = I: unknowns Q_i, B_i = B(W̃_i),
///
///     W̃_i = Q_i† (W₀ Q_i), skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     Q₁  = I - h Σ_j b_j Q_j B_j;            W₁  = Q₁† (W₀ Q₁)
///
/// and of corrections δ_i to Q_i
///
///     (T δ)_i = -h Σ_j a_ij δ_j B_j,          (K δ)_i = -h Σ_j a_ij Q_j B(N_j - N_j†),
///     N_j = δ_j† W₀ Q_j
///
/// Products: 2s and s triangles a sweep, 1 and a triangle for the update, which takes Q_j B_j from
/// the last sweep; in single precision s for T and 2s for K, both within bands.  Q_i is cut to its
/// band, and so is W₀ where stages are formed.  Where corrections failed, a plain sweep transports
/// twice with the same B_j, by which the iteration bears longer steps.
class FastGroup final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void begin_step() override;
  void start_cold() override;
  void begin() override;
  double sweep(double h) override;
  double residual(double h) override;
  Index linearise(double h, double accuracy) override;
  double transport(double h) override;
  double couple(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  void form_stages();       // W₀ Q_j, W̃_j, B_j and Q_j B_j
  void transport_stages();  // Q_j B_j
  double update_Q(double h);

  Tableau tableau_;
  std::vector<PlanarMatrix> W0Q_, W_stage_, B_, QB_;
  PlanarMatrix W0_cut_, Q1_, identity_;
  double tolerance_;
  double W0_weight_;
  Singles Q_single_, B_single_, W0Q_single_, N_, dW_, dB_, product_;
};

}  // namespace isosyrk
