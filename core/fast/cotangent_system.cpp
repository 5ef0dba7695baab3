#include "isosyrk/fast/cotangent_system.h"

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// At half these values a smooth scene needs a third sweep.
constexpr CouplingBand cotangent_coupling_bound = {32, 0.375};

// Forms of_Q(j) and of_P(j) for all stages j, side by side.
template <class Products, class OfQ, class OfP>
void form_pairs(Products& products, std::size_t stages, const OfQ& of_Q, const OfP& of_P) {
  products.form(2 * stages, [&](std::size_t k) {
    const std::size_t j = k / 2;
    return k % 2 == 0 ? of_Q(j) : of_P(j);
  });
}

}  // namespace

CotangentSystem::CotangentSystem(const Flow& flow, const Tableau& tableau, int threads,
                                 bool truncates)
    : RungeKuttaSystem(flow, tableau, {tableau.stages(), tableau.stages()}, threads, truncates,
                       cotangent_coupling_bound),
      identity_(split_identity(flow.size())),
      W_stage_(zeros(s_)),
      B_(generator_.generators(s_)),
      QB_(zeros(s_)),
      PB_(zeros(s_)),
      Q_single_(singles(s_)),
      P_single_(singles(s_)),
      B_single_(generator_.rounded(s_)),
      N_of_Q_(singles(s_)),
      N_of_P_(singles(s_)),
      N_(singles(s_)),
      dB_(singles(s_)),
      Q_product_(singles(s_)),
      P_product_(singles(s_)),
      Q1_(zero()),
      P1_(zero()) {}

void CotangentSystem::start(Unknowns& x, Start) {
  for (SplitMatrix& each : x[Q]) each = identity_;
  for (SplitMatrix& each : x[P]) each = *W0_;
}

ResidualSize CotangentSystem::residual(Corrections& R, Unknowns& x, double) {
  SplitStages& Qs = x[Q];
  SplitStages& Ps = x[P];
  bands_.truncate(Qs, left_out_);
  bands_.truncate(Ps, left_out_);
  products_.form(stages(), [&](std::size_t j) {
    return into(W_stage_[j], adjoint(Qs[j]) * Ps[j]).upper_triangle();
  });
  generate(B_, W_stage_);
  form_pairs(
      products_, stages(), [&](std::size_t j) { return into(QB_[j], Qs[j] * B_[j]); },
      [&](std::size_t j) { return into(PB_[j], Ps[j] * B_[j]); });
  const double of_Q = form_residual(
      R[Q], [&](std::size_t i) { return identity_ - h_ * sum(row(i), QB_); }, Qs);
  const double of_P = form_residual(
      R[P], [&](std::size_t i) { return *W0_ - h_ * sum(row(i), PB_); }, Ps);
  return {.change = larger(of_Q, of_P), .neglected = left_out_};
}

void CotangentSystem::linearise(const Unknowns& x, double accuracy) {
  round_generators(B_single_, B_, accuracy);
  round_to_single(Q_single_, x[Q]);
  round_to_single(P_single_, x[P]);
}

// δ_i <- rhs_i - h Σ_j a_ij δ_j B_j, and ε_i likewise.
double CotangentSystem::frozen_sweep(Corrections& delta, const Corrections& rhs) {
  form_pairs(
      single_products_, stages(),
      [&](std::size_t j) { return into(Q_product_[j], delta[Q][j] * B_single_[j]); },
      [&](std::size_t j) { return into(P_product_[j], delta[P][j] * B_single_[j]); });
  const double of_Q =
      replace(delta[Q], [&](std::size_t i) { return rhs[Q][i] - h_ * sum(row(i), Q_product_); });
  const double of_P =
      replace(delta[P], [&](std::size_t i) { return rhs[P][i] - h_ * sum(row(i), P_product_); });
  return larger(of_Q, of_P);
}

void CotangentSystem::couple(Corrections& coupled, const Corrections& delta) {
  const Index band = B_single_.coupling_band;
  form_pairs(
      single_products_, stages(),
      [&](std::size_t j) {
        return into(N_of_Q_[j], adjoint(delta[Q][j]) * P_single_[j]).upper_triangle().within(band);
      },
      [&](std::size_t j) {
        return into(N_of_P_[j], adjoint(Q_single_[j]) * delta[P][j]).upper_triangle().within(band);
      });
  assign(N_, [&](std::size_t j) { return N_of_Q_[j] + N_of_P_[j]; });
  generator_.generate_within(dB_, band, N_);
  form_pairs(
      single_products_, stages(),
      [&](std::size_t j) { return into(Q_product_[j], Q_single_[j] * dB_[j]); },
      [&](std::size_t j) { return into(P_product_[j], P_single_[j] * dB_[j]); });
  assign(coupled[Q], [&](std::size_t i) { return -h_ * sum(row(i), Q_product_); });
  assign(coupled[P], [&](std::size_t i) { return -h_ * sum(row(i), P_product_); });
}

// Uses Q_j B_j and P_j B_j of the last residual.
void CotangentSystem::update(SplitMatrix& W1, const Unknowns&) {
  Q1_ = identity_ - h_ * sum(b(), QB_);
  P1_ = *W0_ - h_ * sum(b(), PB_);
  products_.form(into(W1, adjoint(Q1_) * P1_).upper_triangle());
  mirror_skew(W1);
}

}  // namespace isosyrk
