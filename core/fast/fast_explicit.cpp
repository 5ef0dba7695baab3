#include "isosyrk/fast/fast_explicit.h"

#include <utility>

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

FastExplicit::FastExplicit(const SharedFlow& flow, const FastOptions& options)
    : SplitIntegrator(flow, options.threads),
      work_(*flow, options.threads, options.bands.value_or(false), 1, tuning.group_coupling),
      tolerance_(options.iteration.tolerance) {
  W_stage_ = product_ = work_.zeros(1);
}

StepReport FastExplicit::take_step(const SplitStages& W0, double h, Past, SplitStages& W1) {
  work_.begin_step(h, tolerance_);
  return {.status = steps(W0, h, W1) ? Status::converged : Status::diverged};
}

void FastExplicit::commutator(const SplitMatrix& A, const SplitMatrix& X, double scale,
                              SplitStages& out) {
  work_.products.form(times(A, X, product_[0]));
  skew_part(product_, scale, out);
}

void FastExplicit::generate(SplitStages& W, SplitStages& B) {
  work_.bands.truncate(work_.left_out(), W);
  work_.generate(W, B);
}

FastRungeKutta4::FastRungeKutta4(const SharedFlow& flow, const FastOptions& options)
    : FastExplicit(flow, options), B_(work_.zeros(1)) {
  k_.fill(B_);
}

bool FastRungeKutta4::steps(const SplitStages& W0, double h, SplitStages& W1) {
  const auto stage = [&](double scale, const SplitStages& slope) {
    assign(W_stage_[0], sum_of(1.0, W0[0]).add(scale, slope[0]));
  };
  const auto slope = [&](SplitStages& k) {
    generate(W_stage_, B_);
    commutator(B_[0], W_stage_[0], 1.0, k);
  };
  assign(W_stage_[0], sum_of(1.0, W0[0]));
  slope(k_[0]);
  stage(0.5 * h, k_[0]);
  slope(k_[1]);
  stage(0.5 * h, k_[1]);
  slope(k_[2]);
  stage(h, k_[2]);
  slope(k_[3]);
  assign(W1[0], sum_of(1.0, W0[0])
                    .add(h / 6.0, k_[0][0])
                    .add(h / 3.0, k_[1][0])
                    .add(h / 3.0, k_[2][0])
                    .add(h / 6.0, k_[3][0]));
  return true;
}

FastMuntheKaas4::FastMuntheKaas4(const SharedFlow& flow, const FastOptions& options)
    : FastExplicit(flow, options) {
  Omega_ = commutator_ = term_ = next_ = work_.zeros(1);
  k_.fill(Omega_);
  Omega_single_ = term_single_ = next_single_ = product_single_ = work_.singles(1);
}

bool FastMuntheKaas4::conjugate(double scale, const SplitStages& Omega, const SplitStages& W,
                                SplitStages& out) {
  constexpr int most_terms = 200;
  constexpr double rounding = 1e-17;  // relative to W, in the Frobenius norm
  const double size_of_W = largest_norm(W);
  assign(out[0], sum_of(1.0, W[0]));
  assign(term_[0], sum_of(1.0, W[0]));
  bool in_single = false;
  for (int k = 1; k <= most_terms; ++k) {
    const double factor = scale / static_cast<double>(k);
    double size = 0.0;
    if (in_single) {
      work_.single_products.form(times(Omega_single_[0], term_single_[0], product_single_[0]));
      skew_part(product_single_, static_cast<float>(factor), next_single_);
      add(next_single_, out);
      std::swap(term_single_, next_single_);
      size = largest_norm(term_single_);
    } else {
      work_.bands.truncate(work_.left_out(), term_);
      commutator(Omega[0], term_[0], factor, next_);
      assign(out[0], sum_of(1.0, out[0]).add(1.0, next_[0]));
      std::swap(term_, next_);
      size = largest_norm(term_);
    }
    if (!std::isfinite(size)) return false;
    if (size <= rounding * size_of_W) return true;
    if (!in_single && size <= tuning.single_term * size_of_W) {
      in_single = true;
      round_to_single(Omega, Omega_single_);
      round_to_single(term_, term_single_);
    }
  }
  return false;
}

bool FastMuntheKaas4::steps(const SplitStages& W0, double h, SplitStages& W1) {
  bool summed = true;
  const auto generate_at = [&](SplitStages& W, SplitStages& k) {
    generate(W, k);
    assign(k[0], sum_of(h, k[0]));
  };
  const auto stage = [&](double scale, const SplitStages& exponent, SplitStages& k) {
    summed = conjugate(scale, exponent, W0, W_stage_) && summed;
    generate_at(W_stage_, k);
  };
  assign(W_stage_[0], sum_of(1.0, W0[0]));
  generate_at(W_stage_, k_[0]);
  stage(0.5, k_[0], k_[1]);
  commutator(k_[0][0], k_[1][0], -0.125, commutator_);
  assign(Omega_[0], sum_of(0.5, k_[1][0]).add(1.0, commutator_[0]));
  stage(1.0, Omega_, k_[2]);
  stage(1.0, k_[2], k_[3]);
  commutator(k_[0][0], k_[3][0], -1.0 / 12.0, commutator_);
  assign(Omega_[0], sum_of(1.0 / 6.0, k_[0][0])
                        .add(1.0 / 3.0, k_[1][0])
                        .add(1.0 / 3.0, k_[2][0])
                        .add(1.0 / 6.0, k_[3][0])
                        .add(1.0, commutator_[0]));
  return conjugate(1.0, Omega_, W0, W1) && summed;
}

}  // namespace isosyrk
