#include "isosyrk/fast/direct_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

constexpr CouplingBand direct_coupling_bound = {32, 0.375};  // that of AlgebraSystem

}  // namespace

DirectSystem::DirectSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates)
    : RungeKuttaSystem(flow, tableau, {tableau.stages()}, threads, truncates,
                       direct_coupling_bound),
      B_(generator_.generators(s_)),
      M_(zeros(s_)),
      commutator_(zeros(s_)),
      W_single_(singles(s_)),
      B_single_(generator_.rounded(s_)),
      dB_(singles(s_)),
      product_(singles(s_)),
      product_skew_(singles(s_)) {}

void DirectSystem::start(Unknowns& x, Start) {
  for (SplitMatrix& W : x[0]) W = *W0_;
}

ResidualSize DirectSystem::residual(Corrections& R, Unknowns& x, double) {
  SplitStages& W = x[0];
  bands_.truncate(W, left_out_);
  generate(B_, W);
  products_.form(stages(), [&](std::size_t j) { return into(M_[j], B_[j] * W[j]); });
  skew_part(commutator_, M_);
  const double change = form_residual(
      R[0], [&](std::size_t i) { return *W0_ + h_ * sum(row(i), commutator_); }, W);
  return {.change = change, .neglected = left_out_};
}

void DirectSystem::linearise(const Unknowns& x, double accuracy) {
  round_generators(B_single_, B_, accuracy);
  round_to_single(W_single_, x[0]);
}

// δ_i <- rhs_i + h Σ_j a_ij [B_j, δ_j].
double DirectSystem::frozen_sweep(Corrections& delta, const Corrections& rhs) {
  single_products_.form(
      stages(), [&](std::size_t j) { return into(product_[j], B_single_[j] * delta[0][j]); });
  skew_part(product_skew_, product_);
  return replace(delta[0],
                 [&](std::size_t i) { return rhs[0][i] + h_ * sum(row(i), product_skew_); });
}

void DirectSystem::couple(Corrections& coupled, const Corrections& delta) {
  generator_.generate_within(dB_, B_single_.coupling_band, delta[0]);
  single_products_.form(stages(),
                        [&](std::size_t j) { return into(product_[j], dB_[j] * W_single_[j]); });
  skew_part(product_skew_, product_);
  assign(coupled[0], [&](std::size_t i) { return h_ * sum(row(i), product_skew_); });
}

// Uses M_j of the last residual.
void DirectSystem::update(SplitMatrix& W1, const Unknowns&) {
  W1 = *W0_ + h_ * sum(b(), commutator_);
}

}  // namespace isosyrk
