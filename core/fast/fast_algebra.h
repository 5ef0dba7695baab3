// The algebra formulation in planar matrices, its structure used.
#pragma once

#include <type_traits>
#include <utility>

#include "isosyrk/fast/fast_form.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// AlgebraForm for J = I in fewer unknowns.  K_ij = Σ_k a_ik M_jk, with
///
///     X_i  = -h (W₀ + Σ_j a_ij X_j) B_i
///     M_jk =  h B_j ( X_k + Σ_m a_jm M_mk ),       M_kj = -M_jk†
///     W̃_i  = W₀ + S - S† + Σ_j a_ij² M_jj,         S = Σ_j a_ij X_j + Σ_{j<k} a_ij a_ik M_jk
///     W₁   = W₀ + h Σ_i b_i (C_i - C_i†),          C_i = B_i W̃_i
///
/// of which only the pairs j <= k are formed, from the X of the same sweep, and M_jj as a triangle;
/// and of corrections δ_i to X_i and ε_jk to M_jk, with R those of X and P_i = W₀ + Σ_j a_ij X_j,
/// Y_jk = X_k + Σ_m a_jm M_mk,
///
///     (T δ)_i  = -h (Σ_j a_ij δ_j) B_i,                     (K δ)_i  = -h P_i δB_i
///     (T ε)_jk =  h B_j ( δ_k - R_k + Σ_m a_jm ε_mk ),      (K ε)_jk =  h δB_j Y_jk
///
/// Products: s(s+1)/2 and s triangles a sweep, s for the update; in single precision the same for T
/// and for K, all within bands.
/// Source: the recursion's solution is M_jk = -h² B_j (Q_j† W₀ Q_k) B_k.
class FastAlgebra final : public FastForm {
 public:
  /// Throws std::invalid_argument for an inconsistent tableau.
  FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options);

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
  using Stages = std::vector<PlanarMatrix>;

  std::size_t stages() const { return W_stage_.size(); }
  double a(std::size_t i, std::size_t j) const {
    return tableau_.a(static_cast<Index>(i), static_cast<Index>(j));
  }
  // (j, k), j <= k, in the order in which M_jk are stored; the last ones are the halved of Items.
  struct Pairs {
    explicit Pairs(std::size_t stages);
    Items items() const { return {order.size(), halved}; }

    std::vector<std::pair<std::size_t, std::size_t>> order;
    std::size_t halved;
  };

  FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options,
              Pairs pairs);

  // Where M_jk, j <= k, stands among the pairs.
  std::size_t pair(std::size_t j, std::size_t k) const { return place_of_pair_[k * stages() + j]; }
  // Y = terms + Σ_m a_jm M_mk, a share of it, for the pair p = (j, k).
  template <class Real>
  void set_pair_sum(std::size_t p, Terms<Real> terms, const std::vector<PlanarMatrixOf<Real>>& M,
                    PlanarMatrixOf<Real>& Y, Share share) const {
    const auto [j, k] = pairs_.order[p];
    for (std::size_t m = 0; m <= k; ++m) terms.add(a(j, m), M[pair(m, k)]);
    assign(Y, share, terms);
    for (std::size_t m = k + 1; m < stages(); ++m) {
      subtract_adjoint(M[pair(k, m)], static_cast<Real>(a(j, m)), Y, share);
    }
  }
  // M_p = h B_j Y_p for the pair p = (j, k), of M_jj the upper triangle.
  template <class Real>
  void multiply_pair(PlanarProductsOf<Real>& products, std::size_t p,
                     const std::vector<PlanarMatrixOf<Real>>& B,
                     const std::vector<PlanarMatrixOf<Real>>& Y,
                     std::vector<PlanarMatrixOf<Real>>& M, std::type_identity_t<Real> h,
                     Share share) const {
    const auto [j, k] = pairs_.order[p];
    if (j == k) {
      products.multiply_upper(B[j], Y[p], M[p], h, share);
    } else {
      products.multiply(B[j], Y[p], M[p], h, share);
    }
  }
  bool is_diagonal(std::size_t p) const { return pairs_.order[p].first == pairs_.order[p].second; }
  template <class Change>
  double form_next(double h, Change&& change);
  void add_rhs(std::size_t kind, std::size_t item, Share share);
  double take_next_delta(std::size_t kind);
  double update_stage_vorticities();
  template <class... Phases>
  double correct_stage_vorticities(const Singles& X, const Singles& M, Phases&&... phases);

  Tableau tableau_;
  Stages X_sum_;   // Σ_j a_ij X_j
  Unknowns next_;  // X and M of the sweep under way
  Stages W_stage_, B_;
  Stages P_, Y_;       // what next_ are products of
  Stages sum_, skew_;  // places to work in
  Pairs pairs_;
  std::vector<std::size_t> place_of_pair_;
  Singles B_single_, P_single_, Y_single_, dW_, dB_, single_input_;
  SingleUnknowns next_delta_;  // where others still read the old one
};

}  // namespace isosyrk
