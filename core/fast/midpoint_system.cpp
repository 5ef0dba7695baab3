#include "isosyrk/fast/midpoint_system.h"

#include <utility>

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// At half these values a smooth scene needs a third sweep.
constexpr CouplingBand midpoint_coupling_bound = {24, 0.125};
// Largest number of Newton-Schulz iterations for 1 / (1 - (h/2) B).
constexpr int max_inverse_iterations = 12;
// Frobenius norm that may be cut from that inverse, as a multiple of the accuracy.
constexpr double left_out_of_inverse = 0.1;

}  // namespace

MidpointSystem::MidpointSystem(const Flow& flow, int threads, bool truncates)
    : SplitSystem(flow, {1}, 1, threads, truncates, midpoint_coupling_bound),
      W_stage_(zeros(1)),
      B_(generator_.generators(1)),
      M_(zeros(1)),
      MB_(zeros(1)),
      commutator_(zeros(1)),
      W_single_(singles(1)),
      B_single_(generator_.rounded(1)),
      X_(singles(1)),
      minus_V_adjoint_(singles(1)),
      K_right_(singles(1)),
      dB_(singles(1)),
      product_(singles(1)),
      other_(singles(1)) {}

std::unique_ptr<StepMemory> MidpointSystem::memory() const {
  return std::make_unique<Memory>(products_.size());
}

void MidpointSystem::bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) {
  SplitSystem::bind(W0, h, tolerance, memory);
  memory_ = static_cast<Memory*>(&memory);
}

void MidpointSystem::start(Unknowns& x, Start) {
  x[0][0].entries().setZero();
  memory_->forget();
}

ResidualSize MidpointSystem::residual(Corrections& R, Unknowns& x, double) {
  W_stage_[0] = *W0_ + x[0][0];
  generate(B_, W_stage_);
  products_.form(into(M_[0], B_[0] * W_stage_[0]));
  products_.form(into(MB_[0], (0.25 * h_ * h_) * M_[0] * B_[0]).upper_triangle());
  mirror_skew(MB_);
  skew_part(commutator_, M_, 0.5 * h_);
  const double change = form_residual(
      R[0], [&](std::size_t) { return commutator_[0] + MB_[0]; }, x[0]);
  return {.change = change, .neglected = left_out_};
}

void MidpointSystem::linearise(const Unknowns&, double accuracy) {
  round_generators(B_single_, B_, accuracy);
  round_to_single(W_single_, W_stage_);
  K_right_[0] = (0.25 * h_ * h_) * B_single_[0];
  add_identity(K_right_, static_cast<float>(0.5 * h_));
  invert(memory_->V, accuracy);
}

// Newton-Schulz iteration for V.
void MidpointSystem::invert(SingleStages& V, double accuracy) {
  const auto set_to_one_plus = [&](SingleStages& Y, double scale) {
    Y[0] = scale * B_single_[0];
    add_identity(Y, 1.0f);
  };
  set_to_one_plus(X_, -0.5 * h_);
  if (!memory_->knows_V) set_to_one_plus(V, 0.5 * h_);
  for (int k = 0; k < max_inverse_iterations; ++k) {
    single_products_.form(into(product_[0], -1.0 * X_[0] * V[0]));
    add_identity(product_, 1.0f);  // 1 - X V
    const double error = largest_norm(product_);
    if (!(error < 1.0) && memory_->knows_V) {  // V belongs to another state or h
      memory_->knows_V = false;
      set_to_one_plus(V, 0.5 * h_);
      continue;
    }
    single_products_.form(into(other_[0], V[0] * product_[0]));
    V[0] = V[0] + other_[0];
    bands_.truncate(V, left_out_of_inverse * accuracy);
    if (error * error < accuracy) break;
  }
  memory_->knows_V = true;
  minus_adjoint(minus_V_adjoint_, V);
}

// δ = V rhs V†.
double MidpointSystem::frozen_sweep(Corrections& delta, const Corrections& rhs) {
  single_products_.form(into(product_[0], memory_->V[0] * rhs[0][0]));
  single_products_.form(into(other_[0], -1.0 * product_[0] * minus_V_adjoint_[0]).upper_triangle());
  mirror_skew(other_);
  return replace(delta[0], [&](std::size_t) { return 1.0 * other_[0]; });
}

void MidpointSystem::couple(Corrections& coupled, const Corrections& delta) {
  generator_.generate_within(dB_, B_single_.coupling_band, delta[0]);
  single_products_.form(into(product_[0], dB_[0] * W_single_[0]));
  single_products_.form(into(other_[0], product_[0] * K_right_[0]));
  skew_part(coupled[0], other_);
}

// Uses M of the last residual.
void MidpointSystem::update(SplitMatrix& W1, const Unknowns&) { W1 = *W0_ + 2.0 * commutator_[0]; }

}  // namespace isosyrk
