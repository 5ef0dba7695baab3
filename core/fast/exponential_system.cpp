#include "isosyrk/fast/exponential_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosyrk/fast/coupling_nodes.h"
#include "isosyrk/integrators/unit_of_exponent.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

const std::array<CouplingNode, 3> nodes = coupling_nodes();

// Error of μ, relative to ‖W₀‖, as a multiple of the accuracy of Ω: B damps the fine scales, where
// most of it lies.  At two fifths of this value steps take 1 to 2 % more products, and the solver's
// part in the energy of long runs stays the same (n = 33, h = 0.5, smooth and rough).
constexpr double error_of_average_of_unit = 5.0;
// Least factor by which hB is taken to damp an error of μ.  It damps rounding and other errors that
// are spread over all l by h/2, whatever state Ω is formed from.
constexpr double least_gain = 0.05;
// The error that one node makes in K δ is about this part of it; seen at h = 0.1 ... 0.5.
constexpr double error_of_one_node = 0.02;
// The error that two nodes make is this part of K δ, times the fourth power of ‖Ω‖_F / √n: 1 /
// 14400 for each (ad_Ω)⁴ / 5 that the quadrature leaves out, beside a weight of 1/2, and about 9
// such powers for a δ that is spread over all l, as the rounding of a start is.
constexpr double error_of_fourth_power = 2.5e-4;
// K contracts by about this factor.
constexpr double contraction_of_K = 0.1;
// K contracts by at least about this multiple of h ‖W₀‖_F / √n: by 0.1 to 0.4 of it for an error
// that is spread over all l, in smooth, rough and steady states, n = 5 to 129.
constexpr double contraction_of_size = 0.1;
// That K is formed from matrices with this many times the error wanted does not show.
constexpr double most_of_moved = 10.0;
// Largest part of its norm that is cut from a matrix, however few digits are wanted.  At 5e-3 ... 1
// steps take the same products, at 1e-4 up to 3 % more (elp4 and elp6 at 1e-8, n = 33, 65 and 129,
// smooth and rough): a bound for states of which little is known yet.
constexpr double coarsest_part = 1e-2;

// ‖E δ‖ / ‖δ‖, where E is the derivative of a term of B̃, as a multiple of the term's part of B̃,
// unless it was seen.  It is 0.8 to 2.5 at steps for errors of 1e-4 to 1e-6, 5 at the coarsest.
// What was seen holds for the first correction of a step: of what a correction leaves the
// derivatives take more, since they are what it leaves out (0.02 to 0.04 of all in place of 0.001,
// elp6 near steady states, n = 9 and 17).
constexpr double likely_derivative = 2.5;
// The least that is taken for it, whatever was seen: the rounding of a start, which is spread over
// all l, shows less of it than an error of large scales does.  E suffices where it might show: with
// 1 in place of 0.25 steps take 4 % fewer to 4 % more products at the tolerance 1e-13, and the same
// at 1e-8 (elp4 and elp6 with and without frame, n = 17 to 129, smooth and rough).
constexpr double least_derivative = 1.0;
// The same for the derivative of the term in h⁴, which is never formed: at 1 steps take up to a
// quarter more products (elp6 at 1e-13, n = 129, rough).
constexpr double least_derivative_of_fourth = 0.25;
// A derivative is left out of a correction if the error stays below this multiple of the forcing
// term.  The estimated error of x is then below the tolerance still.
constexpr double most_left_out = 1.4;
// Forcing term of what a derivative adds, as a part of that of the whole correction.
constexpr double forcing_of_derivative = 0.3;

// An explicit start is of no use where the rounding of a rotation left out of B is a larger part of
// Ω. In single precision that rounding is about n u ‖hR‖_F.
constexpr double largest_rounding = 0.1;

// Order of the explicit method that gives the start values.
int magnus_order(int order) { return order == 6 ? 5 : 4; }

}  // namespace

ExponentialSystem::Linearization::Linearization(Index n)
    : Omega(n), c(n), next_c(n), D(n), sum_of_D(n), BD(n) {
  moved.fill(SingleMatrix(n));
  inner.fill(SingleMatrix(n));
}

ExponentialSystem::ExponentialSystem(const Flow& flow, int order, const FastOptions& options)
    : n_(flow.size()),
      order_(order),
      starts_explicitly_(options.explicit_start),
      is_graded_(options.graded_series),
      products_(n_, options.threads),
      single_products_(n_, options.threads),
      generator_(flow),
      bands_(options.bands.value_or(false), 1, n_),
      lie_(products_, generator_, bands_),
      single_lie_(single_products_, generator_, bands_),
      series_(products_, single_products_, n_, options),
      gradient_(lie_, single_lie_, n_, order),
      magnus_(single_lie_, magnus_order(order)),
      exponential_(n_, bands_),
      start_error_(n_),
      correction_({split_stages(1, n_)}),
      W0_single_(n_),
      mu_(n_),
      v_(n_),
      at_(n_),
      derivative_per_share_(likely_derivative),
      E_delta_({split_stages<float>(1, n_)}),
      more_delta_(E_delta_),
      Omega_cut_(n_) {
  if (options.error_estimates) acceptance_.by = Acceptance::By::error_estimate;
}

std::vector<Attempt> ExponentialSystem::attempts(bool newton) const {
  const Iteration first = newton ? Iteration::newton : Iteration::picard;
  std::vector<Attempt> all = {{Start::predicted, first}};
  if (starts_explicitly_) all.push_back({Start::stepped, first});
  for (const Iteration iteration : {first, Iteration::picard, Iteration::anderson}) {
    all.push_back({Start::cold, iteration});
  }
  return all;
}

void ExponentialSystem::forget() {
  gradient_.forget();
  derivative_per_share_ = likely_derivative;
  start_error_.forget();
  largest_change_ = change_before_ = 0.0;
}

void ExponentialSystem::bind(const SplitMatrix& W0, double h, double tolerance) {
  W0_ = &W0;
  h_ = h;
  tolerance_ = tolerance;
  size_of_W0_ = norm(W0);
  rotation_ = std::abs(h) * generator_.rotation_left_out(W0);
  least_unit_ = least_unit_of_exponent(rotation_, tolerance);
  least_contraction_ =
      contraction_of_size * std::abs(h) * size_of_W0_ / std::sqrt(static_cast<double>(n_));
  round_to_single(W0_single_, W0);
  bands_.truncate_symmetric_to_part(W0_single_, tuning.single_roundoff);
  change_before_ = largest_change_;
  largest_change_ = 0.0;
  is_first_correction_ = true;
  choose_nodes();
}

// True if one node is too few for K δ of a δ of this size, with this error.
bool ExponentialSystem::needs_pair(double size, double error) {
  return !(error_of_one_node * contraction_of_K * size <= error);  // NaN included
}

// Returns the error of K δ with two nodes, relative to ‖δ‖, for an Ω of this norm.
double ExponentialSystem::error_of_two_nodes(double size_of_Omega) const {
  const double mean_square = size_of_Omega * size_of_Omega / static_cast<double>(n_);
  return error_of_fourth_power * mean_square * mean_square * 1.5 * least_contraction_;
}

// Chooses the nodes and the error of e^{s ad_Ω} W₀ that the first correction of the step will need,
// if the first sweep changes Ω by as much as in the step before.
void ExponentialSystem::choose_nodes() {
  const double allowed = tuning.neumann_term * acceptance_.least_forcing_term(tolerance_);
  const bool is_known = change_before_ > 0.0;                          // false for NaN
  has_pair_ = !is_known || needs_pair(1.5 * change_before_, allowed);  // it may be a little more
  // correct() cuts what is formed here to this part.
  const double part = is_known ? std::min(allowed / change_before_, coarsest_part) : 0.0;
  error_of_moved_ = moved_error(part);
}

// Returns the error of e^{s ad_Ω} W₀ that goes unseen beside a cut to this part.
double ExponentialSystem::moved_error(double part) const {
  return std::max(0.1 * part, tuning.single_roundoff) * size_of_W0_;
}

void ExponentialSystem::start(Unknowns& x, Start how) {
  SplitMatrix& Omega = x[0][0];
  if (how != Start::stepped) return start_cold(Omega);
  single_lie_.neglect(tuning.single_roundoff);
  magnus_.form_exponent(at_.Omega, W0_single_, h_);
  widen(Omega, at_.Omega);
  const double rounding = tuning.single_roundoff * static_cast<double>(n_) * rotation_;
  if (rounding > largest_rounding * norm(Omega)) return start_cold(Omega);
  start_error_.mend(Omega, [&](SingleMatrix& out, const SingleMatrix& X) {
    exponential_.carry(out, X, single_products_);
  });
}

void ExponentialSystem::start_cold(SplitMatrix& Omega) {
  lie_.neglect(0.0);
  lie_.generate(Omega, *W0_);
  Omega = h_ * Omega;
}

double ExponentialSystem::unit(const Unknowns& x) const {
  return unit_of_exponent(norm(x[0][0]), least_unit_);
}

// Sets mu_ to φ₁(ad_Ω) W₀ with this error, and e^{s ad_Ω} W₀ at the nodes.
bool ExponentialSystem::form_average(const SplitMatrix& Omega, double error) {
  const std::span<SingleMatrix> moved = moved_in_use();
  mu_ = 1.0 * *W0_;
  for (SingleMatrix& each : moved) each = 1.0 * W0_single_;
  series_.truncate(bands_, 0.1 * error);
  series_.begin(Omega, *W0_, error, GradedSeries::Sum::average);
  bool goes_on = true;
  while (goes_on) {
    goes_on = series_.advance();
    if (series_.failed()) return false;
    const int k = series_.k();
    std::array<Addition<float>, 3> additions;
    std::size_t count = 0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const double weight = std::pow(nodes[i].s, k);
      if (weight * series_.size() > error_of_moved_) additions[count++] = {&moved[i], weight};
    }
    series_.add_upper_to({&mu_, 1.0 / static_cast<double>(k + 1)},
                         std::span<const Addition<float>>(additions.data(), count));
  }
  mirror_skew_in_band(mu_);
  for (SingleMatrix& each : moved) mirror_skew_in_band(each);
  return true;
}

// Returns the error that μ may have, in the Frobenius norm, for an Ω of this accuracy.
double ExponentialSystem::error_of_average(double accuracy, const Unknowns& x) const {
  const double by_size = error_of_average_of_unit * accuracy / unit(x) * size_of_W0_;
  return std::min(by_size, accuracy / (std::abs(h_) * least_gain));
}

ResidualSize ExponentialSystem::residual(Corrections& R, Unknowns& x, double accuracy) {
  SplitMatrix& Omega = x[0][0];
  const double relative = accuracy / unit(x);
  bands_.truncate(x[0], 0.1 * accuracy);
  if (!form_average(Omega, error_of_average(accuracy, x))) {
    return {.change = std::numeric_limits<double>::quiet_NaN(), .neglected = 0.0};
  }
  gradient_.evaluate(v_, mu_, Omega, h_, relative, least_unit_ / std::abs(h_));
  const double change = form_residual(
      R[0], [&](std::size_t) { return h_ * v_; }, x[0]);
  largest_change_ = larger(largest_change_, change / unit(x));
  return {.change = change, .neglected = 0.5 * accuracy};
}

Correction ExponentialSystem::correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                                      const CorrectionRequest& request,
                                      const IterationOptions& options) {
  // K is needed to few digits.
  const double allowed = tuning.neumann_term * request.forcing_term;
  const double part = std::min(allowed / request.size, coarsest_part);
  round_to_single(at_.Omega, x[0][0]);
  cut(part);
  const double least = is_first_correction_ ? 0.0 : likely_derivative;
  is_first_correction_ = false;
  const double derivative = std::max(derivative_per_share_, least);
  Correction correction = solve(delta, R, request, derivative, options);
  if (!has_pair_ && needs_pair(request.size, allowed)) {
    correction.error += error_of_one_node * contraction_of_K * request.size;
  }
  const double of_two_nodes = error_of_two_nodes(norm(x[0][0])) * request.size;
  if (of_two_nodes > allowed) correction.error += of_two_nodes;
  // K errs by what the nodes' matrices do, which were formed for a residual as expected.
  if (error_of_moved_ > most_of_moved * moved_error(part)) {
    correction.error += error_of_moved_ / size_of_W0_ * request.size;
  }
  if (order_ == 6) {  // the derivative of the term in h⁴
    correction.error += std::max(least_derivative_of_fourth, derivative) *
                        gradient_.share_of_derivative_of_fourth() * request.size;
  }
  return correction;
}

// Cuts what K is formed from, which is new.
void ExponentialSystem::cut(double part) {
  single_lie_.cut_to_part(at_.Omega, part);
  for (SingleMatrix& moved : moved_in_use()) single_lie_.cut_to_part(moved, part);
}

// Solves (1 - K - E) δ = R, with E the derivative of the term in h²: δ = Σ_k δ_k, where
//     (1 - K) δ₀ = R,   (1 - K) δ_k = E δ_{k-1}.
// ‖E δ‖ / ‖δ‖ is expected to be `derivative` times the share of that term.
Correction ExponentialSystem::solve(Corrections& delta, const Corrections& R,
                                    const CorrectionRequest& request, double derivative,
                                    const IterationOptions& options) {
  const double most_left = most_left_out * request.forcing_term;
  double left = 0.0;
  if (order_ > 2) {
    left = std::max(least_derivative, derivative) * gradient_.share_of_second() * request.size;
  }
  const auto expect = [&](double size_of_E_delta) {
    left = size_of_E_delta;
    sums_D_ = left > most_left - request.forcing_term;
    has_sum_of_D_ = false;
  };
  expect(left);
  Correction correction = correction_.solve(delta, *this, R, request, options);
  double size = request.size;
  while (correction.usable && has_sum_of_D_ && correction.error + left > most_left) {
    differentiate(0.1 * most_left / left);
    const double added = largest_norm(E_delta_[0]);
    if (!(added < size)) return {};  // NaN included
    if (size == request.size) {
      derivative_per_share_ = added / size / gradient_.share_of_second();
    }
    expect(added * added / size);
    size = added;
    const CorrectionRequest of_E_delta = {
        .size = size, .forcing_term = forcing_of_derivative * request.forcing_term};
    const Correction more = correction_.solve(more_delta_, *this, E_delta_, of_E_delta, options);
    if (!more.usable) return {};
    delta[0][0] = delta[0][0] + more_delta_[0][0];
    correction.error += more.error;
  }
  correction.error += left;
  return correction;
}

void ExponentialSystem::couple(Corrections& coupled, const Corrections& delta, double accuracy) {
  couple(coupled[0][0], delta[0][0], accuracy);
}

void ExponentialSystem::couple(SingleMatrix& coupled, const SingleMatrix& delta, double accuracy) {
  Linearization& at = at_;
  SplitLie<float>& lie = single_lie_;
  const double size = norm(delta);
  lie.neglect(std::max(accuracy / size, double{tuning.single_roundoff}));
  const bool takes_pair = has_pair_ && needs_pair(size, accuracy);
  const std::size_t first = takes_pair ? 1 : 0;
  const std::size_t count = takes_pair ? 2 : 1;
  const double largest_node = nodes[first + count - 1].s;
  at.c = 1.0 * delta;
  lie.cut(at.c);
  for (std::size_t i = 0; i < count; ++i) at.inner[i] = 1.0 * at.c;
  constexpr int most_terms = 60;
  const double end = is_graded_ ? accuracy : std::min(accuracy, tuning.single_roundoff * size);
  TermGrowth growth;
  growth.begin(size);
  for (int j = 1; j < most_terms; ++j) {
    const double factor = 1.0 / static_cast<double>(j + 1);
    lie.bracket(at.next_c, at.Omega, at.c, factor);
    std::swap(at.c, at.next_c);
    for (std::size_t i = 0; i < count; ++i) {
      at.inner[i] = at.inner[i] + std::pow(nodes[first + i].s, j) * at.c;
    }
    // c_j and c_{j+1} in K δ
    const double size_of_c = norm(at.c);
    growth.saw(size_of_c, factor);
    const double next = largest_node * growth.next(1.0 / static_cast<double>(j + 2));
    const double weight = contraction_of_K * std::pow(largest_node, j);
    if (!(weight * std::min(size_of_c, next) > end)) break;  // NaN included
  }
  lie.bracket(at.D, at.inner[0], at.moved[first], nodes[first].weight);
  if (count == 2) {
    lie.add_bracket(at.D, at.inner[1], at.moved[first + 1], nodes[first + 1].weight);
  }
  lie.generate(at.BD, at.D);
  coupled = h_ * at.BD;
  if (!sums_D_) return;
  if (has_sum_of_D_) {
    at.sum_of_D = at.sum_of_D + at.D;
  } else {
    std::swap(at.sum_of_D, at.D);
  }
  has_sum_of_D_ = true;
}

// Sets E_delta_ to E δ for the δ that K was applied to since sums_D_ was set.  Of its norm, `part`
// may be left out.
void ExponentialSystem::differentiate(double part) {
  single_lie_.neglect(std::min(part, coarsest_part));
  single_lie_.cut(at_.sum_of_D);
  single_lie_.generate(at_.BD, at_.sum_of_D);
  gradient_.derivative_of_second(E_delta_[0][0], at_.sum_of_D, at_.BD, h_);
  E_delta_[0][0] = h_ * E_delta_[0][0];
}

void ExponentialSystem::update(SplitMatrix& W1, const Unknowns& x) {
  Omega_cut_ = 1.0 * x[0][0];
  const double error = 0.1 * tolerance_ * unit(x);
  bands_.truncate(Omega_cut_, error);
  if (!exponential_.conjugate(W1, Omega_cut_, *W0_, error, products_, single_products_)) {
    W1.re()[0] = std::numeric_limits<double>::quiet_NaN();  // the step diverges
  }
  start_error_.saw(x[0][0]);
}

}  // namespace isosyrk
