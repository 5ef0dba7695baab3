#include "isosyrk/fast/algebra_system.h"

#include "isosyrk/split/skew.h"

namespace isosyrk {

AlgebraSystem::AlgebraSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : SplitSystem(flow, tableau, threads, truncates, tuning.algebra_coupling) {
  for (std::size_t k = 1; k < stages(); ++k) {
    for (std::size_t j = 0; j < k; ++j) pairs_.emplace_back(j, k);
  }
  const auto pairs = static_cast<Index>(pairs_.size());
  X_sum_ = half_ = skew_ = W_stage_ = B_ = P_ = work_.zeros(s_);
  C_sum_ = C_skew_ = work_.zeros(1);
  M_below_ = work_.zeros(pairs);
  fresh_ = unknowns();
  Y_ = {{}, work_.zeros(s_), work_.zeros(pairs)};
  X_sum_single_ = half_single_ = dW_ = B_single_ = P_single_ = dB_ = work_.singles(s_);
  M_below_single_ = work_.singles(pairs);
  fresh_single_ = corrections_like(fresh_);
  Y_single_ = input_ = corrections_like(Y_);
}

void AlgebraSystem::cold_start(Unknowns& x) {
  for (SplitStages& kind : x) {
    for (SplitMatrix& unknown : kind) unknown.entries().setZero();
  }
}

// Returns sum + Σ_{j<k} a_ij a_ik M_jk.  With sum = Σ_j a_ij X_j this is S_i.
template <class Real>
LinearCombination<Real> AlgebraSystem::half_of_stage(std::size_t i, LinearCombination<Real> sum,
                                                     const KindsOf<Real>& x) const {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const auto [j, k] = pairs_[p];
    sum.add(a(i, j) * a(i, k), x[above][p]);
  }
  return sum;
}

// Returns sum + Σ_j a_ij² M_jj.
template <class Real>
LinearCombination<Real> AlgebraSystem::add_diagonal(std::size_t i, LinearCombination<Real> sum,
                                                    const KindsOf<Real>& x) const {
  for (std::size_t j = 0; j < stages(); ++j) sum.add(a(i, j) * a(i, j), x[diagonal][j]);
  return sum;
}

// Y_jk = X_k + Σ_m a_jm M_mk, j <= k, with M_mk = -M_km† for m > k.
template <class Real>
void AlgebraSystem::form_Y(const KindsOf<Real>& x, SplitStagesOf<Real>& below,
                           KindsOf<Real>& Y) const {
  minus_adjoint(x[above], below);
  const auto place = [](std::size_t j, std::size_t k) { return k * (k - 1) / 2 + j; };
  const auto Y_of = [&](std::size_t j, std::size_t k) {
    auto sum = sum_of(1.0, x[X][k]);
    for (std::size_t m = 0; m < stages(); ++m) {
      sum.add(a(j, m), m < k ? x[above][place(m, k)] : m > k ? below[place(k, m)] : x[diagonal][k]);
    }
    return sum;
  };
  assign(Y[diagonal], [&](std::size_t j) { return Y_of(j, j); });
  assign(Y[above], [&](std::size_t p) { return Y_of(pairs_[p].first, pairs_[p].second); });
}

// M_jk = h B_j Y_jk, j <= k.
template <class Real>
void AlgebraSystem::form_M(SplitProductsOf<Real>& products, const SplitStagesOf<Real>& B,
                           const KindsOf<Real>& Y, KindsOf<Real>& M) const {
  const auto h = static_cast<Real>(h_);
  products.form(stages() + pairs_.size(), [&](std::size_t p) {
    if (p < stages()) return times(B[p], Y[diagonal][p], M[diagonal][p], h).upper_triangle();
    p -= stages();
    return times(B[pairs_[p].first], Y[above][p], M[above][p], h);
  });
  mirror_skew(M[diagonal]);
}

// Sets X_sum_ to Σ_j a_ij X_j and W_stage_ to W̃_i.
void AlgebraSystem::form_stages(const Unknowns& x) {
  assign(X_sum_, [&](std::size_t i) { return sum_of(row(i), x[X]); });
  if (pairs_.empty()) {
    skew_part(X_sum_, 1.0, skew_);
  } else {
    assign(half_, [&](std::size_t i) { return half_of_stage(i, sum_of(1.0, X_sum_[i]), x); });
    skew_part(half_, 1.0, skew_);
  }
  assign(W_stage_,
         [&](std::size_t i) { return add_diagonal(i, sum_of(1.0, *W0_).add(1.0, skew_[i]), x); });
}

double AlgebraSystem::residual(Unknowns& x, double, Corrections& R) {
  form_stages(x);
  work_.generate(W_stage_, B_);
  assign(P_, [&](std::size_t i) { return sum_of(1.0, *W0_).add(1.0, X_sum_[i]); });
  work_.products.form(stages(),
                      [&](std::size_t i) { return times(P_[i], B_[i], fresh_[X][i], -h_); });
  form_Y(x, M_below_, Y_);
  form_M(work_.products, B_, Y_, fresh_);
  double change = 0.0;
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    change = larger(
        change, isosyrk::residual(
                    x[kind], [&](std::size_t i) { return sum_of(1.0, fresh_[kind][i]); }, R[kind]));
  }
  change_of_stages(R);
  return larger(change, largest_norm(dW_));
}

// Sets dW_ to the change of W̃ for corrections to X and M.
void AlgebraSystem::change_of_stages(const Corrections& delta) {
  assign(half_single_,
         [&](std::size_t i) { return half_of_stage(i, sum_of(row(i), delta[X]), delta); });
  skew_part(half_single_, 1.0f, dW_);
  assign(dW_, [&](std::size_t i) { return add_diagonal(i, sum_of(1.0, dW_[i]), delta); });
}

void AlgebraSystem::linearise(double accuracy) {
  work_.round_generators(accuracy, B_, B_single_);
  round_to_single(P_, P_single_);
  for (const std::size_t kind : {diagonal, above}) round_to_single(Y_[kind], Y_single_[kind]);
}

// Uses the new X for M (Gauss-Seidel).  The fixed point is the same and the sweeps contract faster.
double AlgebraSystem::frozen_sweep(const Corrections& rhs, Corrections& delta) {
  assign(X_sum_single_, [&](std::size_t i) { return sum_of(row(i), delta[X]); });
  work_.single_products.form(stages(), [&](std::size_t i) {
    return times(X_sum_single_[i], B_single_[i], fresh_single_[X][i], static_cast<float>(-h_));
  });
  const auto take_fresh = [&](std::size_t kind) {
    return replace(delta[kind], [&](std::size_t i) {
      return sum_of(1.0, rhs[kind][i]).add(1.0, fresh_single_[kind][i]);
    });
  };
  const double of_X = take_fresh(X);
  form_Y(delta, M_below_single_, input_);
  form_M(work_.single_products, B_single_, input_, fresh_single_);
  return larger(of_X, larger(take_fresh(diagonal), take_fresh(above)));
}

void AlgebraSystem::couple(const Corrections& delta, Corrections& coupled) {
  change_of_stages(delta);
  work_.generate_coupled(dW_, dB_);
  work_.single_products.form(stages(), [&](std::size_t i) {
    return times(P_single_[i], dB_[i], coupled[X][i], static_cast<float>(-h_));
  });
  form_M(work_.single_products, dB_, Y_single_, coupled);
}

void AlgebraSystem::update(const Unknowns& x, SplitMatrix& W1) {
  form_stages(x);
  work_.generate(W_stage_, B_);
  SplitStages& C = fresh_[X];
  work_.products.form(stages(), [&](std::size_t i) { return times(B_[i], W_stage_[i], C[i]); });
  assign(C_sum_[0], sum_of(h_ * tableau_.b, C));
  skew_part(C_sum_, 1.0, C_skew_);
  assign(W1, sum_of(1.0, *W0_).add(1.0, C_skew_[0]));
}

}  // namespace isosyrk
