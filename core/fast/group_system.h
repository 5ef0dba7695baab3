// The group formulation in split-complex storage.
#pragma once

#include "isosyrk/fast/split_system.h"

namespace isosyrk {

/// GroupForm for J = I, with unknowns Q_i.  With B_i = B(W̃_i) the equations are
///
///     W̃_i = Q_i† (W₀ Q_i), skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     Q₁  = I - h Σ_j b_j Q_j B_j;            W₁  = Q₁† (W₀ Q₁)
///
/// For corrections δ_i to Q_i the two parts of the Jacobian are
///
///     (T δ)_i = -h Σ_j a_ij δ_j B_j,          (K δ)_i = -h Σ_j a_ij Q_j B(N_j - N_j†),
///     N_j = δ_j† W₀ Q_j
///
/// The update uses Q_j B_j of the last residual.  Q_i is truncated, and in the stages also W₀.
/// Products in double precision: 2s and s triangles a residual, 1 and 1 triangle for the update.
/// Products in single precision, within bands: s for T, 2s for K.
/// Poisson solves: s a residual, none for the update, s for K.
/// Source: GroupForm.
class GroupSystem final : public SplitSystem {
 public:
  /// As SplitSystem.
  GroupSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  Unknowns unknowns() const override { return {work_.zeros(s_)}; }
  void bind(const SplitMatrix& W0, double h, double tolerance) override;
  void cold_start(Unknowns& x) override;
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;

 private:
  const SplitStages* Q_ = nullptr;  // of the last residual
  SplitMatrix identity_, Q1_;
  SplitStages W0_cut_, W0Q_, W_stage_, B_, QB_;
  SingleStages Q_single_, B_single_, W0Q_single_, N_, dW_, dB_, product_;
};

}  // namespace isosyrk
