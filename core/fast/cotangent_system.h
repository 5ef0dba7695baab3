// The cotangent formulation in split-complex storage.
#pragma once

#include "isosyrk/fast/split_workspace.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// CotangentForm for J = I: unknowns Q_i, P_i, B_i = B(W̃_i),
///
///     W̃_i = Q_i† P_i, taken as skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     P_i = W₀ - h Σ_j a_ij P_j B_j;             W₁  = Q₁† P₁, likewise with b_j
///
/// and of corrections δ_i to Q_i and ε_i to P_i
///
///     (T δ)_i = -h Σ_j a_ij δ_j B_j,   (K δ)_i = -h Σ_j a_ij Q_j B(N_j),   N_j = δ_j† P_j + Q_j† ε_j
///
/// and for ε the same with P_j in place of Q_j.
///
/// Products: 2s and s triangles a residual, a triangle for the update, which takes Q_j B_j and P_j B_j
/// from the last residual; in single precision 2s for T, 2s and 2s triangles for K, within bands.
/// Q_i and P_i are truncated.  With P_i = W₀ Q_i this is the group form, in as many products.
class CotangentSystem final : public StageSystem {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau, or a flow that has no generator in
  /// split storage.
  CotangentSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  Unknowns unknowns() const override { return {work_.zeros(s_), work_.zeros(s_)}; }
  void bind(const SplitMatrix& W0, double h, double tolerance) override;
  void cold_start(Unknowns& x) override;
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;
  bool truncates() const override { return work_.bands.enabled(); }
  void truncate(bool enabled) override { work_.bands.enable(enabled); }
  StepReport work() const override { return work_.work(); }

 private:
  auto step_row(std::size_t i) const { return -h_ * tableau_.a.row(static_cast<Index>(i)); }

  Tableau tableau_;
  Index s_;
  SplitWorkspace work_;
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
  const Unknowns* x_ = nullptr;  // of the last residual
  SplitMatrix identity_, Q1_, P1_;
  SplitStages W_stage_, B_, QB_, PB_;
  SingleStages Q_single_, P_single_, B_single_, N_, N_of_P_, dB_, Q_product_, P_product_;
};

}  // namespace isosyrk
