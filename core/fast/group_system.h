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
class GroupSystem final : public RungeKuttaSystem {
 public:
  /// As RungeKuttaSystem.
  GroupSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  void bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) override;
  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  void linearise(const Unknowns& x, double accuracy) override;
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override;
  void couple(Corrections& coupled, const Corrections& delta) override;
  void update(SplitMatrix& W1, const Unknowns& x) override;

 private:
  SplitMatrix identity_;  // I
  SplitStages W0_cut_;    // W₀, cut to its band: a single matrix
  // Of the last residual.
  SplitStages W0Q_;      // W₀ Q_j
  SplitStages W_stage_;  // W̃_j, upper triangles
  Generators B_;         // B_j
  SplitStages QB_;       // Q_j B_j
  // Of the Jacobian, in single precision.
  SingleStages Q_single_;       // Q_j
  SingleStages W0Q_single_;     // W₀ Q_j
  RoundedGenerators B_single_;  // B_j
  SingleStages N_;              // N_j = δ_j† W₀ Q_j
  SingleStages dW_;             // δW̃_j = N_j - N_j†, upper triangles
  SingleStages dB_;             // B(δW̃_j)
  SingleStages product_;        // δ_j B_j or Q_j B(δW̃_j)
  // Of the update.
  SplitMatrix Q1_;    // Q₁
  SplitMatrix W0Q1_;  // W₀ Q₁
};

}  // namespace isosyrk
