#include "isosyrk/fast/group_system.h"

#include <cmath>

#include "isosyrk/split/congruence.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// At half these values a smooth scene needs a third sweep.
constexpr CouplingBand group_coupling_bound = {16, 0.125};

}  // namespace

GroupSystem::GroupSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : RungeKuttaSystem(flow, tableau, {tableau.stages()}, threads, truncates, group_coupling_bound),
      identity_(split_identity(flow.size())),
      W0_cut_(zeros(1)),
      W0Q_(zeros(s_)),
      W_stage_(zeros(s_)),
      B_(generator_.generators(s_)),
      QB_(zeros(s_)),
      Q_single_(singles(s_)),
      W0Q_single_(singles(s_)),
      B_single_(generator_.rounded(s_)),
      N_(singles(s_)),
      dW_(singles(s_)),
      dB_(singles(s_)),
      product_(singles(s_)),
      Q1_(zero()),
      W0Q1_(zero()) {}

void GroupSystem::bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) {
  RungeKuttaSystem::bind(W0, h, tolerance, memory);
  W0_cut_[0] = 1.0 * W0;
  bands_.truncate(W0_cut_, left_out_ / (std::abs(h) * generator_.norm_bound()));
}

void GroupSystem::start(Unknowns& x, Start) {
  for (SplitMatrix& Q : x[0]) Q = identity_;
}

ResidualSize GroupSystem::residual(Corrections& R, Unknowns& x, double) {
  SplitStages& Q = x[0];
  bands_.truncate(Q, left_out_);
  products_.form(stages(), [&](std::size_t j) { return into(W0Q_[j], W0_cut_[0] * Q[j]); });
  products_.form(stages(), [&](std::size_t j) {
    return into(W_stage_[j], adjoint(Q[j]) * W0Q_[j]).upper_triangle();
  });
  generate(B_, W_stage_);
  products_.form(stages(), [&](std::size_t j) { return into(QB_[j], Q[j] * B_[j]); });
  const double change = form_residual(
      R[0], [&](std::size_t i) { return identity_ - h_ * sum(row(i), QB_); }, Q);
  return {.change = change, .neglected = left_out_};
}

void GroupSystem::linearise(const Unknowns& x, double accuracy) {
  round_generators(B_single_, B_, accuracy);
  round_to_single(Q_single_, x[0]);
  round_to_single(W0Q_single_, W0Q_);
}

// δ_i <- rhs_i - h Σ_j a_ij δ_j B_j.
double GroupSystem::frozen_sweep(Corrections& delta, const Corrections& rhs) {
  single_products_.form(
      stages(), [&](std::size_t j) { return into(product_[j], delta[0][j] * B_single_[j]); });
  return replace(delta[0], [&](std::size_t i) { return rhs[0][i] - h_ * sum(row(i), product_); });
}

void GroupSystem::couple(Corrections& coupled, const Corrections& delta) {
  const Index band = B_single_.coupling_band;
  single_products_.form(stages(), [&](std::size_t j) {
    return into(N_[j], adjoint(delta[0][j]) * W0Q_single_[j]).within(band);
  });
  upper_skew_part_within(dW_, band, N_);
  generator_.generate_within(dB_, band, dW_);
  single_products_.form(stages(),
                        [&](std::size_t j) { return into(product_[j], Q_single_[j] * dB_[j]); });
  assign(coupled[0], [&](std::size_t i) { return -h_ * sum(row(i), product_); });
}

// Uses Q_j B_j of the last residual.
void GroupSystem::update(SplitMatrix& W1, const Unknowns&) {
  Q1_ = identity_ - h_ * sum(b(), QB_);
  congruence(W1, W0Q1_, products_, Q1_, *W0_);
}

}  // namespace isosyrk
