#include "isosyrk/fast/fast_explicit.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// Of the stages of the Munthe-Kaas method, as parts of the estimated error of a step.  Measured to
// T = 5 with and without the frame, smooth and rough, n = 17 to 129, errors from 1e-2 to 1e-9: the
// answer moves by at most 0.4 % of its error.
//
// Error of the series of a stage.  At three times this value 2 to 5 % of the products less; at a
// third up to 4 % more.
constexpr double stage_share = 0.3;
// Norm that may be cut from a factor in a stage, as a part of the error of its series.  At three
// times this value a smooth scene moves by 1.2 % of its error.
constexpr double stage_left_out = 0.1;
// Largest ratio of the estimates of two steps for which the first serves the second.
constexpr double stage_error_growth = 3.0;

// Smallest tolerance at which the explicit Magnus methods form Ω in single precision.
constexpr double smallest_single_tolerance = 1e-6;

}  // namespace

FastExplicit::FastExplicit(const SharedFlow& flow, const FastOptions& options)
    : SplitIntegrator(flow, options.threads),
      products_(flow->size(), options.threads),
      single_products_(flow->size(), options.threads),
      generator_(*flow),
      bands_(options.bands.value_or(false), 1, flow->size()),
      left_out_(tuning.left_out * options.iteration.tolerance),
      product_(zeros(1)) {}

StepReport FastExplicit::take_step(SplitStages& W1, const SplitStages& W0, double h,
                                   StepMemory& memory) {
  h_ = h;
  return {.status = take_explicit_step(W1, W0, h, memory) ? Status::converged : Status::diverged};
}

void FastExplicit::commutator(SplitStages& out, const SplitMatrix& A, const SplitMatrix& X,
                              double scale) {
  products_.form(into(product_[0], A * X));
  skew_part(out, product_, scale);
}

void FastExplicit::generate(Generators& B, SplitStages& W, double of_W, double of_hB) {
  bands_.truncate(W, of_W);
  generator_.generate(B, W, bands_, of_hB / std::abs(h_));
}

FastRungeKutta::FastRungeKutta(const SharedFlow& flow, const Tableau& tableau,
                               const FastOptions& options)
    : FastExplicit(flow, options),
      tableau_(tableau),
      W_stage_(zeros(1)),
      B_(generators()),
      slope_(zeros(1)),
      k_(zeros(tableau_.stages())) {
  require_explicit(tableau_);
}

bool FastRungeKutta::take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                                        StepMemory&) {
  for (std::size_t i = 0; i < k_.size(); ++i) {
    W_stage_[0] = W0[0] + h * sum(tableau_.a.row(static_cast<Index>(i)), k_);
    slope(k_[i], W_stage_);
  }
  W1[0] = W0[0] + h * sum(tableau_.b, k_);
  return true;
}

void FastRungeKutta::slope(SplitMatrix& k, SplitStages& W) {
  generate(B_, W);
  commutator(slope_, B_[0], W[0]);
  std::swap(k, slope_[0]);
}

FastMultistep::FastMultistep(const SharedFlow& flow, const MultistepScheme& scheme,
                             const FastOptions& options)
    : FastRungeKutta(flow, scheme.start, options),
      scheme_(scheme),
      predicted_(zeros(1)),
      predicted_slope_(zeros(1)) {
  auto of_run = std::make_unique<Memory>();
  of_run->past.emplace(zeros(scheme.predictor.size()));
  remember(std::move(of_run), std::make_unique<Memory>());
}

bool FastMultistep::take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                                       StepMemory& memory) {
  auto& past = static_cast<Memory&>(memory).past;
  if (!past) return FastRungeKutta::take_explicit_step(W1, W0, h, memory);
  SplitMatrix& f = past->join(h);
  if (!past->is_complete()) {
    const bool is_taken = FastRungeKutta::take_explicit_step(W1, W0, h, memory);
    f = 1.0 * first_slope();
    return is_taken;
  }
  copy(predicted_, W0);
  slope(f, predicted_);
  predicted_[0] = W0[0] + h * sum(scheme_.predictor, past->slopes());
  slope(predicted_slope_[0], predicted_);
  W1[0] = W0[0] + (h * scheme_.of_predicted) * predicted_slope_[0] +
          h * sum(scheme_.corrector, past->slopes());
  return true;
}

FastMuntheKaas4::FastMuntheKaas4(const SharedFlow& flow, const FastOptions& options)
    : FastExplicit(flow, options),
      scheme_(munthe_kaas4()),
      tolerance_(options.iteration.tolerance),
      series_(products_, single_products_, flow->size(), options),
      exponential_(flow->size(), bands()),
      Omega_(zeros(1)),
      adjoint_(flow->size()),
      commutator_(zeros(1)),
      W_stage_(zeros(1)),
      B_(generators()),
      k_(zeros(scheme_.tableau.stages())) {
  remember(std::make_unique<Memory>(), std::make_unique<Memory>());
}

void FastMuntheKaas4::set_stage_error(double error) {
  stage_error_ = std::max(tolerance_, stage_share * error) * scale_;
}

StepReport FastMuntheKaas4::take_step(SplitStages& W1, const SplitStages& W0, double h,
                                      StepMemory& of_steps) {
  auto& memory = static_cast<Memory&>(of_steps);
  scale_ = norm(W0[0]);
  set_stage_error(std::abs(h) == memory.h ? memory.error : 0.0);
  const double taken = stage_error_;
  StepReport report = FastExplicit::take_step(W1, W0, h, memory);
  if (report.status != Status::converged) return report;
  set_stage_error(stage_error_growth * error_);
  if (taken > stage_error_) {
    set_stage_error(error_);
    report = FastExplicit::take_step(W1, W0, h, memory);
  }
  memory.h = std::abs(h);
  memory.error = error_;
  return report;
}

// Sets Omega_ to Ω_i of a stage i > 0, or to Ω for stage s.
void FastMuntheKaas4::form_exponent(std::size_t stage) {
  const Tableau& tableau = scheme_.tableau;
  LinearCombination<double> Omega =
      stage < k_.size() ? sum(tableau.a.row(static_cast<Index>(stage)), k_) : sum(tableau.b, k_);
  for (const auto& each : scheme_.commutators) {
    if (each.stage != stage) continue;
    commutator(commutator_, k_[each.left], k_[each.right], each.weight);
    Omega += commutator_[0];
  }
  Omega_[0] = Omega;
}

// W1 = U W₀ U†, with U = e^Ω to this error and unitary to rounding.
bool FastMuntheKaas4::conjugate(SplitMatrix& W1, const SplitMatrix& W0, double error_of_U) {
  if (exponential_.conjugate(W1, adjoint_, Omega_[0], W0, error_of_U, products_,
                             single_products_)) {
    return true;
  }
  const double error = GradedSeries::conjugation_error * scale_;
  series_.truncate(bands(), error);
  return series_.conjugate(W1, Omega_[0], W0, error);
}

bool FastMuntheKaas4::take_explicit_step(SplitStages& W1, const SplitStages& W0, double h,
                                         StepMemory&) {
  const double left_out = stage_left_out * stage_error_;
  const double of_Omega = scale_ > 0.0 ? left_out / scale_ : 0.0;
  series_.truncate(bands(), left_out);
  for (std::size_t i = 0; i < k_.size(); ++i) {
    if (i == 0) {
      copy(W_stage_, W0);
    } else {
      form_exponent(i);
      if (!series_.conjugate(W_stage_[0], Omega_[0], W0[0], stage_error_)) return false;
    }
    generate(B_, W_stage_, left_out, of_Omega);
    k_[i] = h * B_[0];
  }
  form_exponent(k_.size());
  bands().truncate(Omega_, of_Omega);
  if (!conjugate(W1[0], W0[0], of_Omega)) return false;
  // e, from the last stage
  W_stage_[0] = W1[0] - W_stage_[0];
  const double change = scale_ > 0.0 ? norm(W_stage_[0]) / scale_ : 0.0;
  error_ = std::min(1.0, 3.0 * std::pow(change, 5.0 / 3.0));
  return true;
}

FastMagnus::FastMagnus(const SharedFlow& flow, const MagnusScheme& scheme,
                       const FastOptions& options)
    : FastExplicit(flow, options),
      is_single_(options.iteration.tolerance >= smallest_single_tolerance),
      lie_(products_, generator_, bands()),
      single_lie_(single_products_, generator_, bands()),
      exponential_(flow->size(), bands()),
      Omega_(flow->size()),
      adjoint_(flow->size()),
      Omega_single_(flow->size()),
      W0_single_(flow->size()) {
  if (is_single_) {
    single_lie_.neglect(std::max(left_out(), tuning.single_roundoff));
    single_exponent_.emplace(single_lie_, scheme);
  } else {
    lie_.neglect(left_out());
    exponent_.emplace(lie_, scheme);
  }
}

bool FastMagnus::take_explicit_step(SplitStages& W1, const SplitStages& W0, double h, StepMemory&) {
  if (is_single_) {
    round_to_single(W0_single_, W0[0]);
    single_exponent_->form_exponent(Omega_single_, W0_single_, h);
    widen(Omega_, Omega_single_);
  } else {
    exponent_->form_exponent(Omega_, W0[0], h);
  }
  bands().truncate_symmetric_to_part(Omega_, left_out());
  const double error = left_out() * norm(Omega_);
  return exponential_.conjugate(W1[0], adjoint_, Omega_, W0[0], error, products_, single_products_);
}

}  // namespace isosyrk
