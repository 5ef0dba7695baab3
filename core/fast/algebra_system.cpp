#include "isosyrk/fast/algebra_system.h"

#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// At half these values a smooth scene needs a third sweep.
constexpr CouplingBand algebra_coupling_bound = {32, 0.375};

Index pairs_of(Index s) { return s * (s - 1) / 2; }

// The place of M_jk, j < k, in its kind.
std::size_t place(std::size_t j, std::size_t k) { return k * (k - 1) / 2 + j; }

}  // namespace

AlgebraSystem::AlgebraSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : RungeKuttaSystem(flow, tableau,
                       {tableau.stages(), tableau.stages(), pairs_of(tableau.stages())}, threads,
                       truncates, algebra_coupling_bound),
      X_sum_(zeros(s_)),
      half_(zeros(s_)),
      skew_(zeros(s_)),
      W_stage_(zeros(s_)),
      B_(generator_.generators(s_)),
      P_(zeros(s_)),
      M_below_(zeros(pairs_of(s_))),
      Y_({{}, zeros(s_), zeros(pairs_of(s_))}),
      fresh_(unknowns()),
      C_sum_(zeros(1)),
      C_skew_(zeros(1)),
      B_single_(generator_.rounded(s_)),
      P_single_(singles(s_)),
      Y_single_(corrections_like(Y_)),
      X_sum_single_(singles(s_)),
      half_single_(singles(s_)),
      dW_(singles(s_)),
      dB_(singles(s_)),
      M_below_single_(singles(pairs_of(s_))),
      change_of_Y_(corrections_like(Y_)),
      fresh_single_(corrections_like(fresh_)) {
  for (std::size_t k = 1; k < stages(); ++k) {
    for (std::size_t j = 0; j < k; ++j) pairs_.emplace_back(j, k);
  }
}

void AlgebraSystem::start(Unknowns& x, Start) {
  for (SplitStages& kind : x) {
    for (SplitMatrix& unknown : kind) unknown.entries().setZero();
  }
}

// Adds Σ_{j<k} a_ij a_ik M_jk.  To Σ_j a_ij X_j this makes S_i.
template <class Real>
void AlgebraSystem::add_pairs(LinearCombination<Real>& half, std::size_t i,
                              const KindsOf<Real>& x) const {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const auto [j, k] = pairs_[p];
    half += (a(i, j) * a(i, k)) * x[above][p];
  }
}

// Adds Σ_j a_ij² M_jj.
template <class Real>
void AlgebraSystem::add_diagonal(LinearCombination<Real>& stage, std::size_t i,
                                 const KindsOf<Real>& x) const {
  for (std::size_t j = 0; j < stages(); ++j) stage += (a(i, j) * a(i, j)) * x[diagonal][j];
}

// Y_jk = X_k + Σ_m a_jm M_mk, j <= k, with M_mk = -M_km† for m > k.
template <class Real>
void AlgebraSystem::form_Y(KindsOf<Real>& Y, SplitStagesOf<Real>& below,
                           const KindsOf<Real>& x) const {
  minus_adjoint(below, x[above]);
  const auto M = [&](std::size_t m, std::size_t k) -> const SplitMatrixOf<Real>& {
    if (m < k) return x[above][place(m, k)];
    if (m > k) return below[place(k, m)];
    return x[diagonal][k];
  };
  const auto Y_of = [&](std::size_t j, std::size_t k) {
    LinearCombination<Real> Y_jk = x[X][k];
    for (std::size_t m = 0; m < stages(); ++m) Y_jk += a(j, m) * M(m, k);
    return Y_jk;
  };
  assign(Y[diagonal], [&](std::size_t j) { return Y_of(j, j); });
  assign(Y[above], [&](std::size_t p) { return Y_of(pairs_[p].first, pairs_[p].second); });
}

// M_jk = h B_j Y_jk, j <= k.
template <class Real>
void AlgebraSystem::form_M(KindsOf<Real>& M, SplitProductsOf<Real>& products,
                           const SplitStagesOf<Real>& B, const KindsOf<Real>& Y) const {
  products.form(stages() + pairs_.size(), [&](std::size_t k) {
    if (k < stages()) {
      return into(M[diagonal][k], h_ * B[k] * Y[diagonal][k]).upper_triangle();
    }
    const std::size_t p = k - stages();
    return into(M[above][p], h_ * B[pairs_[p].first] * Y[above][p]);
  });
  mirror_skew(M[diagonal]);
}

// Sets X_sum_, and W_stage_ to W̃_i = W₀ + S_i - S_i† + Σ_j a_ij² M_jj.
void AlgebraSystem::form_stages(const Unknowns& x) {
  assign(X_sum_, [&](std::size_t i) { return sum(row(i), x[X]); });
  if (pairs_.empty()) {
    skew_part(skew_, X_sum_);
  } else {
    assign(half_, [&](std::size_t i) {
      LinearCombination<double> S_i = X_sum_[i];
      add_pairs(S_i, i, x);
      return S_i;
    });
    skew_part(skew_, half_);
  }
  assign(W_stage_, [&](std::size_t i) {
    LinearCombination<double> W_i = *W0_ + skew_[i];
    add_diagonal(W_i, i, x);
    return W_i;
  });
}

ResidualSize AlgebraSystem::residual(Corrections& R, Unknowns& x, double) {
  form_stages(x);
  generate(B_, W_stage_);
  assign(P_, [&](std::size_t i) { return *W0_ + X_sum_[i]; });
  products_.form(stages(), [&](std::size_t i) { return into(fresh_[X][i], -h_ * P_[i] * B_[i]); });
  form_Y(Y_, M_below_, x);
  form_M(fresh_, products_, B_.B, Y_);
  double change = 0.0;
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    const auto fresh = [&](std::size_t i) { return 1.0 * fresh_[kind][i]; };
    change = larger(change, form_residual(R[kind], fresh, x[kind]));
  }
  form_change_of_stages(R);
  return {.change = larger(change, largest_norm(dW_)), .neglected = left_out_};
}

// Sets dW_ to the change of W̃ for corrections to X and M.
void AlgebraSystem::form_change_of_stages(const Corrections& delta) {
  assign(half_single_, [&](std::size_t i) {
    LinearCombination<float> S_i = sum(row(i), delta[X]);
    add_pairs(S_i, i, delta);
    return S_i;
  });
  skew_part(dW_, half_single_);
  assign(dW_, [&](std::size_t i) {
    LinearCombination<float> dW_i = dW_[i];
    add_diagonal(dW_i, i, delta);
    return dW_i;
  });
}

void AlgebraSystem::linearise(const Unknowns&, double accuracy) {
  round_generators(B_single_, B_, accuracy);
  round_to_single(P_single_, P_);
  for (const std::size_t kind : {diagonal, above}) round_to_single(Y_single_[kind], Y_[kind]);
}

// Uses the new δ for ε (Gauss-Seidel).  The fixed point is the same and the sweeps contract faster.
double AlgebraSystem::frozen_sweep(Corrections& delta, const Corrections& rhs) {
  assign(X_sum_single_, [&](std::size_t i) { return sum(row(i), delta[X]); });
  single_products_.form(stages(), [&](std::size_t i) {
    return into(fresh_single_[X][i], -h_ * X_sum_single_[i] * B_single_[i]);
  });
  const auto renew = [&](std::size_t kind) {
    return replace(delta[kind],
                   [&](std::size_t i) { return rhs[kind][i] + fresh_single_[kind][i]; });
  };
  const double of_X = renew(X);
  form_Y(change_of_Y_, M_below_single_, delta);
  form_M(fresh_single_, single_products_, B_single_.B, change_of_Y_);
  return larger(of_X, larger(renew(diagonal), renew(above)));
}

void AlgebraSystem::couple(Corrections& coupled, const Corrections& delta) {
  form_change_of_stages(delta);
  generator_.generate_within(dB_, B_single_.coupling_band, dW_);
  single_products_.form(
      stages(), [&](std::size_t i) { return into(coupled[X][i], -h_ * P_single_[i] * dB_[i]); });
  form_M(coupled, single_products_, dB_, Y_single_);
}

// W₁ = W₀ + h Σ_i b_i (C_i - C_i†), with C_i = B_i W̃_i of the accepted x.
void AlgebraSystem::update(SplitMatrix& W1, const Unknowns& x) {
  form_stages(x);
  generate(B_, W_stage_);
  SplitStages& C = fresh_[X];
  products_.form(stages(), [&](std::size_t i) { return into(C[i], B_[i] * W_stage_[i]); });
  C_sum_[0] = h_ * sum(b(), C);
  skew_part(C_skew_, C_sum_);
  W1 = *W0_ + C_skew_[0];
}

}  // namespace isosyrk
