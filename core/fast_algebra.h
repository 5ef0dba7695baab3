// The algebra formulation in planar matrices, its structure used.
#pragma once

#include <utility>

#include "core/fast_form.h"
#include "core/tableau.h"

namespace isosyrk {

/// AlgebraForm for J = I in fewer unknowns.  K_ij = Σ_k a_ik M_jk, with
///
///     X_i  = -h (W₀ + Σ_j a_ij X_j) B_i
///     M_jk =  h B_j ( X_k + Σ_m a_jm M_mk ),       M_kj = -M_jk†
///     W̃_i  = W₀ + S - S† + Σ_j a_ij² M_jj,         S = Σ_j a_ij X_j + Σ_{j<k} a_ij a_ik M_jk
///     W₁   = W₀ + h Σ_i b_i (C_i - C_i†),          C_i = B_i W̃_i
///
/// of which only the pairs j <= k are formed, from the X of the same sweep, and M_jj as a triangle.
/// Products: s(s+1)/2 and s triangles a sweep, s for the update.
/// Source: the recursion's solution is M_jk = -h² B_j (Q_j† W₀ Q_k) B_k.
class FastAlgebra final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

 protected:
  void start_cold() override;
  void begin() override;
  double sweep(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  using Stages = std::vector<PlanarMatrix>;

  std::size_t stages() const { return W_stage_.size(); }
  double a(std::size_t i, std::size_t j) const {
    return tableau_.a(static_cast<Index>(i), static_cast<Index>(j));
  }
  // Where M_jk, j <= k, stands among the pairs.
  static std::size_t pair(std::size_t j, std::size_t k) { return k * (k + 1) / 2 + j; }
  // M_jk for any j, k.
  const PlanarMatrix& M(std::size_t j, std::size_t k) const {
    return j <= k ? unknowns_[1][pair(j, k)] : minus_adjoints_[pair(k, j)];
  }
  void update_stage_vorticities();

  Tableau tableau_;
  Stages X_sum_;  // Σ_j a_ij X_j
  Stages X_next_, M_next_;
  Stages minus_adjoints_;  // -M_jk† where j < k
  Stages W_stage_, B_;
  Stages input_, skew_;                                     // places to work in
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // (j, k), j <= k, as they are stored
  RealVector X_change_, M_change_, W_change_;
};

}  // namespace isosyrk
