// The algebra formulation in split-complex storage.
#pragma once

#include <utility>
#include <vector>

#include "isosyrk/fast/split_system.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

/// AlgebraForm for J = I, with unknowns X_i and M_jk, j <= k.  K_ij = Σ_k a_ik M_jk, where
///
///     X_i  = -h P_i B_i,                P_i  = W₀ + Σ_j a_ij X_j
///     M_jk =  h B_j Y_jk,               Y_jk = X_k + Σ_m a_jm M_mk,       M_kj = -M_jk†
///     W̃_i  = W₀ + S_i - S_i† + Σ_j a_ij² M_jj,   S_i = Σ_j a_ij X_j + Σ_{j<k} a_ij a_ik M_jk
///     W₁   = W₀ + h Σ_i b_i (C_i - C_i†),        C_i = B_i W̃_i
///
/// M_jj is skew-Hermitian and formed as a triangle.  Let δ_i and ε_jk be corrections to X_i and
/// M_jk, and δW̃_i the change of W̃_i that follows.  The two parts of the Jacobian are
///
///     (T δ)_i  = -h (Σ_j a_ij δ_j) B_i,                 (K δ)_i  = -h P_i B(δW̃_i)
///     (T ε)_jk =  h B_j (δ_k + Σ_m a_jm ε_mk),          (K ε)_jk =  h B(δW̃_j) Y_jk
///
/// frozen_sweep uses the new δ for ε.
/// Products in double precision: s(s+1)/2 and s triangles a residual, s for the update.
/// Products in single precision, within bands: s(s+1)/2 and s triangles each for T and for K.
/// Poisson solves: s a residual, s for the update, s for K.
/// Source: the recursion for K_ij in AlgebraForm; it has M_jk = -h² B_j (Q_j† W₀ Q_k) B_k.
class AlgebraSystem final : public RungeKuttaSystem {
 public:
  /// As RungeKuttaSystem.
  AlgebraSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  void start(Unknowns& x, Start how) override;
  /// The change includes the change of W̃, as in AlgebraForm.
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  void linearise(const Unknowns& x, double accuracy) override;
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override;
  void couple(Corrections& coupled, const Corrections& delta) override;
  void update(SplitMatrix& W1, const Unknowns& x) override;

 private:
  // Kinds of unknowns: X_i; M_jj; M_jk with j < k, ordered by k, then j.
  static constexpr std::size_t X = 0, diagonal = 1, above = 2;

  template <class Real>
  using KindsOf = std::vector<SplitStagesOf<Real>>;

  // The sums of the equations, for x the unknowns or corrections to them.
  template <class Real>
  void add_pairs(LinearCombination<Real>& half, std::size_t i, const KindsOf<Real>& x) const;
  template <class Real>
  void add_diagonal(LinearCombination<Real>& stage, std::size_t i, const KindsOf<Real>& x) const;
  template <class Real>
  void form_Y(KindsOf<Real>& Y, SplitStagesOf<Real>& below, const KindsOf<Real>& x) const;
  template <class Real>
  void form_M(KindsOf<Real>& M, SplitProductsOf<Real>& products, const SplitStagesOf<Real>& B,
              const KindsOf<Real>& Y) const;
  void form_stages(const Unknowns& x);
  void form_change_of_stages(const Corrections& delta);

  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // (j, k) of M_jk, j < k
  // Of the last residual.
  SplitStages X_sum_;    // Σ_j a_ij X_j
  SplitStages half_;     // S_i
  SplitStages skew_;     // S_i - S_i†
  SplitStages W_stage_;  // W̃_i
  Generators B_;         // B_i
  SplitStages P_;        // P_i
  SplitStages M_below_;  // M_kj = -M_jk†, j < k
  Unknowns Y_;           // Y_jk, ordered as M_jk; no kind X
  Unknowns fresh_;       // G(x): new X_i and M_jk
  // Of the update.
  SplitStages C_sum_;   // h Σ_i b_i C_i
  SplitStages C_skew_;  // h Σ_i b_i (C_i - C_i†)
  // Of the Jacobian, in single precision.
  RoundedGenerators B_single_;   // B_i
  SingleStages P_single_;        // P_i
  Corrections Y_single_;         // Y_jk
  SingleStages X_sum_single_;    // Σ_j a_ij δ_j
  SingleStages half_single_;     // S_i of the corrections
  SingleStages dW_;              // δW̃_i
  SingleStages dB_;              // B(δW̃_i)
  SingleStages M_below_single_;  // -ε_jk†, j < k
  Corrections change_of_Y_;      // δ_k + Σ_m a_jm ε_mk
  Corrections fresh_single_;     // T δ and T ε
};

}  // namespace isosyrk
