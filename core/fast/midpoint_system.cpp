#include "isosyrk/fast/midpoint_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {

MidpointSystem::MidpointSystem(const Flow& flow, int threads, bool truncates)
    : SplitSystem(flow, gauss_tableau(1), threads, truncates, tuning.midpoint_coupling) {
  W_stage_ = B_ = M_ = MB_ = commutator_ = work_.zeros(1);
  W_single_ = B_single_ = K_right_ = dB_ = product_ = other_ = X_ = V_ = minus_V_adjoint_ =
      work_.singles(1);
}

void MidpointSystem::cold_start(Unknowns& x) {
  x[0][0].entries().setZero();
  knows_V_ = false;
}

double MidpointSystem::residual(Unknowns& x, double, Corrections& R) {
  assign(W_stage_[0], sum_of(1.0, *W0_).add(1.0, x[0][0]));
  work_.generate(W_stage_, B_);
  work_.products.form(times(B_[0], W_stage_[0], M_[0]));
  work_.products.form(times(M_[0], B_[0], MB_[0], 0.25 * h_ * h_).upper_triangle());
  mirror_skew(MB_);
  skew_part(M_, 0.5 * h_, commutator_);
  return isosyrk::residual(
      x[0], [&](std::size_t) { return sum_of(1.0, commutator_[0]).add(1.0, MB_[0]); }, R[0]);
}

void MidpointSystem::linearise(double accuracy) {
  work_.round_generators(accuracy, B_, B_single_);
  round_to_single(W_stage_, W_single_);
  assign(K_right_[0], sum_of(0.25 * h_ * h_, B_single_[0]));
  add_identity(static_cast<float>(0.5 * h_), K_right_);
  invert(accuracy);
}

void MidpointSystem::invert(double accuracy) {
  const auto set_to_one_plus = [&](double scale, SingleStages& Y) {
    assign(Y[0], sum_of(scale, B_single_[0]));
    add_identity(1.0f, Y);
  };
  set_to_one_plus(-0.5 * h_, X_);
  if (!knows_V_) set_to_one_plus(0.5 * h_, V_);
  for (int k = 0; k < tuning.inverse_iterations; ++k) {
    work_.single_products.form(times(X_[0], V_[0], product_[0], -1.0f));
    add_identity(1.0f, product_);
    const double error = largest_norm(product_);
    if (!(error < 1.0) && knows_V_) {  // V_ belongs to another state or h
      knows_V_ = false;
      set_to_one_plus(0.5 * h_, V_);
      continue;
    }
    work_.single_products.form(times(V_[0], product_[0], other_[0]));
    assign(V_[0], sum_of(1.0, V_[0]).add(1.0, other_[0]));
    work_.bands.truncate(tuning.of_inverse * accuracy, V_);
    if (error * error < accuracy) break;
  }
  knows_V_ = true;
  minus_adjoint(V_, minus_V_adjoint_);
}

double MidpointSystem::frozen_sweep(const Corrections& rhs, Corrections& delta) {
  work_.single_products.form(times(V_[0], rhs[0][0], product_[0]));
  work_.single_products.form(
      times(product_[0], minus_V_adjoint_[0], other_[0], -1.0f).upper_triangle());
  mirror_skew(other_);
  return replace(delta[0], [&](std::size_t) { return sum_of(1.0, other_[0]); });
}

void MidpointSystem::couple(const Corrections& delta, Corrections& coupled) {
  work_.generate_coupled(delta[0], dB_);
  work_.single_products.form(times(dB_[0], W_single_[0], product_[0]));
  work_.single_products.form(times(product_[0], K_right_[0], other_[0]));
  skew_part(other_, 1.0f, coupled[0]);
}

void MidpointSystem::update(const Unknowns&, SplitMatrix& W1) {
  assign(W1, sum_of(1.0, *W0_).add(2.0, commutator_[0]));
}

}  // namespace isosyrk
