#include "isosyrk/fast/cotangent_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

CotangentSystem::CotangentSystem(const Flow& flow, const Tableau& tableau, int threads,
                                 bool truncates)
    : SplitSystem(flow, tableau, threads, truncates, tuning.cotangent_coupling),
      identity_(work_.identity()) {
  Q1_ = P1_ = work_.zero();
  W_stage_ = B_ = QB_ = PB_ = work_.zeros(s_);
  Q_single_ = P_single_ = B_single_ = N_ = N_of_P_ = dB_ = Q_product_ = P_product_ =
      work_.singles(s_);
}

void CotangentSystem::cold_start(Unknowns& x) {
  for (SplitMatrix& Q : x[0]) Q = identity_;
  for (SplitMatrix& P : x[1]) P = *W0_;
}

double CotangentSystem::residual(Unknowns& x, double, Corrections& R) {
  x_ = &x;
  SplitStages& Q = x[0];
  SplitStages& P = x[1];
  const std::size_t s = Q.size();
  work_.bands.truncate(work_.left_out(), Q);
  work_.bands.truncate(work_.left_out(), P);
  work_.products.form(
      s, [&](std::size_t j) { return adjoint_times(Q[j], P[j], W_stage_[j]).upper_triangle(); });
  work_.generate(W_stage_, B_);
  work_.products.form(2 * s, [&](std::size_t k) {
    const std::size_t j = k / 2;
    return k % 2 == 0 ? times(Q[j], B_[j], QB_[j]) : times(P[j], B_[j], PB_[j]);
  });
  const double of_Q = isosyrk::residual(
      Q, [&](std::size_t i) { return sum_of(1.0, identity_).add(-h_ * row(i), QB_); }, R[0]);
  const double of_P = isosyrk::residual(
      P, [&](std::size_t i) { return sum_of(1.0, *W0_).add(-h_ * row(i), PB_); }, R[1]);
  return larger(of_Q, of_P);
}

void CotangentSystem::linearise(double accuracy) {
  work_.round_generators(accuracy, B_, B_single_);
  round_to_single((*x_)[0], Q_single_);
  round_to_single((*x_)[1], P_single_);
}

double CotangentSystem::frozen_sweep(const Corrections& rhs, Corrections& delta) {
  work_.single_products.form(2 * Q_product_.size(), [&](std::size_t k) {
    const std::size_t j = k / 2;
    return k % 2 == 0 ? times(delta[0][j], B_single_[j], Q_product_[j])
                      : times(delta[1][j], B_single_[j], P_product_[j]);
  });
  const double of_Q = replace(delta[0], [&](std::size_t i) {
    return sum_of(1.0, rhs[0][i]).add(-h_ * row(i), Q_product_);
  });
  const double of_P = replace(delta[1], [&](std::size_t i) {
    return sum_of(1.0, rhs[1][i]).add(-h_ * row(i), P_product_);
  });
  return larger(of_Q, of_P);
}

void CotangentSystem::couple(const Corrections& delta, Corrections& coupled) {
  const Index band = work_.coupling_band();
  work_.single_products.form(2 * N_.size(), [&](std::size_t k) {
    const std::size_t j = k / 2;
    const ProductOf<float> product = k % 2 == 0
                                         ? adjoint_times(delta[0][j], P_single_[j], N_[j])
                                         : adjoint_times(Q_single_[j], delta[1][j], N_of_P_[j]);
    return product.upper_triangle().within(band);
  });
  assign(N_, [&](std::size_t j) { return sum_of(1.0, N_[j]).add(1.0, N_of_P_[j]); });
  work_.generate_coupled(N_, dB_);
  work_.single_products.form(2 * dB_.size(), [&](std::size_t k) {
    const std::size_t j = k / 2;
    return k % 2 == 0 ? times(Q_single_[j], dB_[j], Q_product_[j])
                      : times(P_single_[j], dB_[j], P_product_[j]);
  });
  assign(coupled[0], [&](std::size_t i) { return sum_of(-h_ * row(i), Q_product_); });
  assign(coupled[1], [&](std::size_t i) { return sum_of(-h_ * row(i), P_product_); });
}

void CotangentSystem::update(const Unknowns&, SplitMatrix& W1) {
  assign(Q1_, sum_of(1.0, identity_).add(-h_ * tableau_.b, QB_));
  assign(P1_, sum_of(1.0, *W0_).add(-h_ * tableau_.b, PB_));
  work_.products.form(adjoint_times(Q1_, P1_, W1).upper_triangle());
  mirror_skew(W1);
}

}  // namespace isosyrk
