#include "isosyrk/fast/group_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

GroupSystem::GroupSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : SplitSystem(flow, tableau, threads, truncates, tuning.group_coupling),
      identity_(work_.identity()) {
  W0_cut_ = work_.zeros(1);
  Q1_ = work_.zero();
  W0Q_ = W_stage_ = B_ = QB_ = work_.zeros(s_);
  Q_single_ = B_single_ = W0Q_single_ = N_ = dW_ = dB_ = product_ = work_.singles(s_);
}

void GroupSystem::bind(const SplitMatrix& W0, double h, double tolerance) {
  SplitSystem::bind(W0, h, tolerance);
  assign(W0_cut_[0], sum_of(1.0, W0));
  work_.bands.truncate(work_.left_out() / (std::abs(h) * work_.generator_bound()), W0_cut_);
}

void GroupSystem::cold_start(Unknowns& x) {
  for (SplitMatrix& Q : x[0]) Q = identity_;
}

double GroupSystem::residual(Unknowns& x, double, Corrections& R) {
  SplitStages& Q = x[0];
  Q_ = &Q;
  work_.bands.truncate(work_.left_out(), Q);
  work_.products.form(Q.size(), [&](std::size_t j) { return times(W0_cut_[0], Q[j], W0Q_[j]); });
  work_.products.form(Q.size(), [&](std::size_t j) {
    return adjoint_times(Q[j], W0Q_[j], W_stage_[j]).upper_triangle();
  });
  work_.generate(W_stage_, B_);
  work_.products.form(Q.size(), [&](std::size_t j) { return times(Q[j], B_[j], QB_[j]); });
  return isosyrk::residual(
      Q, [&](std::size_t i) { return sum_of(1.0, identity_).add(-h_ * row(i), QB_); }, R[0]);
}

void GroupSystem::linearise(double accuracy) {
  work_.round_generators(accuracy, B_, B_single_);
  round_to_single(*Q_, Q_single_);
  round_to_single(W0Q_, W0Q_single_);
}

double GroupSystem::frozen_sweep(const Corrections& rhs, Corrections& delta) {
  work_.single_products.form(product_.size(), [&](std::size_t j) {
    return times(delta[0][j], B_single_[j], product_[j]);
  });
  return replace(delta[0],
                 [&](std::size_t i) { return sum_of(1.0, rhs[0][i]).add(-h_ * row(i), product_); });
}

void GroupSystem::couple(const Corrections& delta, Corrections& coupled) {
  const Index band = work_.coupling_band();
  work_.single_products.form(N_.size(), [&](std::size_t j) {
    return adjoint_times(delta[0][j], W0Q_single_[j], N_[j]).within(band);
  });
  upper_skew_part_within(band, N_, dW_);
  work_.generate_coupled(dW_, dB_);
  work_.single_products.form(
      product_.size(), [&](std::size_t j) { return times(Q_single_[j], dB_[j], product_[j]); });
  assign(coupled[0], [&](std::size_t i) { return sum_of(-h_ * row(i), product_); });
}

void GroupSystem::update(const Unknowns&, SplitMatrix& W1) {
  assign(Q1_, sum_of(1.0, identity_).add(-h_ * tableau_.b, QB_));
  work_.products.form(times(*W0_, Q1_, W0Q_[0]));
  work_.products.form(adjoint_times(Q1_, W0Q_[0], W1).upper_triangle());
  mirror_skew(W1);
}

}  // namespace isosyrk
