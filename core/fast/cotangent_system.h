// The cotangent formulation in split-complex storage.
#pragma once

#include "isosyrk/fast/split_system.h"

namespace isosyrk {

/// CotangentForm for J = I, with unknowns Q_i and P_i.  With B_i = B(W̃_i) the equations are
///
///     W̃_i = Q_i† P_i, taken as skew-Hermitian;   Q_i = I - h Σ_j a_ij Q_j B_j
///     P_i = W₀ - h Σ_j a_ij P_j B_j;             W₁  = Q₁† P₁
///
/// where Q₁ and P₁ are the sums with b_j in place of a_ij.  For corrections δ_i to Q_i and ε_i to
/// P_i the two parts of the Jacobian are
///
///     (T δ)_i = -h Σ_j a_ij δ_j B_j,   (K δ)_i = -h Σ_j a_ij Q_j B(N_j),
///     N_j = δ_j† P_j + Q_j† ε_j
///
/// and (T ε)_i, (K ε)_i follow with ε_j in place of δ_j and P_j in place of Q_j.
///
/// The update uses Q_j B_j and P_j B_j of the last residual.  Q_i and P_i are truncated.
/// Products in double precision: 2s and s triangles a residual, 1 triangle for the update.
/// Products in single precision, within bands: 2s for T; 2s and 2s triangles for K.
/// Poisson solves: s a residual, none for the update, s for K.
/// Source: CotangentForm.  With P_i = W₀ Q_i this is GroupSystem, with as many products a residual.
class CotangentSystem final : public RungeKuttaSystem {
 public:
  /// As RungeKuttaSystem.
  CotangentSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  // Kinds of unknowns.
  static constexpr std::size_t Q = 0, P = 1;

  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  void linearise(const Unknowns& x, double accuracy) override;
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override;
  void couple(Corrections& coupled, const Corrections& delta) override;
  void update(SplitMatrix& W1, const Unknowns& x) override;

 private:
  SplitMatrix identity_;  // I
  // Of the last residual.
  SplitStages W_stage_;  // W̃_j, upper triangles
  Generators B_;         // B_j
  SplitStages QB_, PB_;  // Q_j B_j and P_j B_j
  // Of the Jacobian, in single precision.
  SingleStages Q_single_, P_single_;    // Q_j and P_j
  RoundedGenerators B_single_;          // B_j
  SingleStages N_of_Q_, N_of_P_;        // δ_j† P_j and Q_j† ε_j
  SingleStages N_;                      // N_j, upper triangles
  SingleStages dB_;                     // B(N_j)
  SingleStages Q_product_, P_product_;  // δ_j B_j and ε_j B_j, or Q_j B(N_j) and P_j B(N_j)
  // Of the update.
  SplitMatrix Q1_, P1_;  // Q₁ and P₁
};

}  // namespace isosyrk
