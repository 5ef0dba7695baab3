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
/// frozen_sweep takes the new δ for ε.
/// Products in double precision: s(s+1)/2 and s triangles a residual, s for the update.
/// Products in single precision, within bands: s(s+1)/2 and s triangles each for T and for K.
/// Poisson solves: s a residual, s for the update, s for K.
/// Source: the recursion for K_ij in AlgebraForm; it has M_jk = -h² B_j (Q_j† W₀ Q_k) B_k.
class AlgebraSystem final : public SplitSystem {
 public:
  /// As SplitSystem.
  AlgebraSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  /// Returns three kinds: X_i; M_jj; M_jk with j < k, ordered by k, then j.
  Unknowns unknowns() const override {
    return {work_.zeros(s_), work_.zeros(s_), work_.zeros(s_ * (s_ - 1) / 2)};
  }
  void cold_start(Unknowns& x) override;
  /// The change includes the change of W̃, as in AlgebraForm.
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;

 private:
  // Kinds of unknowns.
  static constexpr std::size_t X = 0, diagonal = 1, above = 2;

  std::size_t stages() const { return static_cast<std::size_t>(s_); }
  double a(std::size_t i, std::size_t j) const {
    return tableau_.a(static_cast<Index>(i), static_cast<Index>(j));
  }

  template <class Real>
  using KindsOf = std::vector<SplitStagesOf<Real>>;
  template <class Real>
  LinearCombination<Real> half_of_stage(std::size_t i, LinearCombination<Real> sum,
                                        const KindsOf<Real>& x) const;
  template <class Real>
  LinearCombination<Real> add_diagonal(std::size_t i, LinearCombination<Real> sum,
                                       const KindsOf<Real>& x) const;
  template <class Real>
  void form_Y(const KindsOf<Real>& x, SplitStagesOf<Real>& below, KindsOf<Real>& Y) const;
  template <class Real>
  void form_M(SplitProductsOf<Real>& products, const SplitStagesOf<Real>& B, const KindsOf<Real>& Y,
              KindsOf<Real>& M) const;
  void form_stages(const Unknowns& x);
  void change_of_stages(const Corrections& delta);

  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // (j, k) of M_jk, j < k
  SplitStages X_sum_, half_, skew_, W_stage_, B_, P_;       // half_: S_i, skew_: S_i - S_i†
  SplitStages C_sum_, C_skew_;                              // of the update
  SplitStages M_below_;                                     // M_kj = -M_jk†
  Unknowns Y_, fresh_;                                      // ordered as the unknowns; Y_ has no X
  SingleStages X_sum_single_, half_single_, dW_, B_single_, P_single_, dB_, M_below_single_;
  Corrections Y_single_, input_, fresh_single_;
};

}  // namespace isosyrk
