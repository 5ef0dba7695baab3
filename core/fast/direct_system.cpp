#include "isosyrk/fast/direct_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

DirectSystem::DirectSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : SplitSystem(flow, tableau, threads, truncates, tuning.algebra_coupling) {
  B_ = M_ = commutator_ = work_.zeros(s_);
  W_single_ = B_single_ = dB_ = product_ = product_skew_ = work_.singles(s_);
}

void DirectSystem::cold_start(Unknowns& x) {
  for (SplitMatrix& W : x[0]) W = *W0_;
}

double DirectSystem::residual(Unknowns& x, double, Corrections& R) {
  SplitStages& W = x[0];
  W_stage_ = &W;
  work_.bands.truncate(work_.left_out(), W);
  work_.generate(W, B_);
  work_.products.form(W.size(), [&](std::size_t j) { return times(B_[j], W[j], M_[j]); });
  skew_part(M_, 1.0, commutator_);
  return isosyrk::residual(
      W, [&](std::size_t i) { return sum_of(1.0, *W0_).add(h_ * row(i), commutator_); }, R[0]);
}

void DirectSystem::linearise(double accuracy) {
  work_.round_generators(accuracy, B_, B_single_);
  round_to_single(*W_stage_, W_single_);
}

double DirectSystem::frozen_sweep(const Corrections& rhs, Corrections& delta) {
  work_.single_products.form(product_.size(), [&](std::size_t j) {
    return times(B_single_[j], delta[0][j], product_[j]);
  });
  skew_part(product_, 1.0f, product_skew_);
  return replace(delta[0], [&](std::size_t i) {
    return sum_of(1.0, rhs[0][i]).add(h_ * row(i), product_skew_);
  });
}

void DirectSystem::couple(const Corrections& delta, Corrections& coupled) {
  work_.generate_coupled(delta[0], dB_);
  work_.single_products.form(
      product_.size(), [&](std::size_t j) { return times(dB_[j], W_single_[j], product_[j]); });
  skew_part(product_, 1.0f, product_skew_);
  assign(coupled[0], [&](std::size_t i) { return sum_of(h_ * row(i), product_skew_); });
}

void DirectSystem::update(const Unknowns&, SplitMatrix& W1) {
  assign(W1, sum_of(1.0, *W0_).add(h_ * tableau_.b, commutator_));
}

}  // namespace isosyrk
