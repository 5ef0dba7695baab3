#include "isosyrk/fast/exponential_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// Gauss quadrature of ∫₀¹ f(s) s ds, with one node and with two.  Σ w = 1/2, Σ w s = 1/3.
struct Node {
  double s;
  double weight;
};
const double root6 = std::sqrt(6.0);
const std::array<Node, 3> nodes = {{{2.0 / 3.0, 0.5},
                                    {(6.0 - root6) / 10.0, 0.25 - 1.0 / (6.0 * root6)},
                                    {(6.0 + root6) / 10.0, 0.25 + 1.0 / (6.0 * root6)}}};

// Error of μ, relative to ‖W₀‖, as a multiple of the accuracy of Ω: B damps the fine scales, where
// most of it lies.  At two fifths of this value steps take 1 to 2 % more products, and the solver's
// part in the energy of long runs stays the same (n = 33, h = 0.5, smooth and rough).
constexpr double error_of_average = 5.0;
// The error that one node makes in K δ is about this part of it; seen at h = 0.1 ... 0.5.
constexpr double error_of_one_node = 0.02;
// K contracts by about this factor.
constexpr double contraction_of_K = 0.1;
// Largest part of its norm that is cut from a matrix, however few digits are wanted.  At 5e-3 ... 1
// steps take the same products, at 1e-4 up to 3 % more (elp4 and elp6 at 1e-8, n = 33, 65 and 129,
// smooth and rough): a bound for states of which little is known yet.
constexpr double coarsest_part = 1e-2;

}  // namespace

ExponentialSystem::ExponentialSystem(const Flow& flow, int order, int threads, bool truncates)
    : n_(flow.size()),
      order_(order),
      products_(n_, threads),
      single_products_(n_, threads),
      generator_(flow),
      bands_(truncates, 1, n_),
      lie_(products_, generator_, bands_),
      single_lie_(single_products_, generator_, bands_),
      series_(products_, single_products_, n_),
      gradient_(lie_, order == 6),
      single_gradient_(single_lie_, order == 6),
      magnus_(single_lie_, order == 6 ? 5 : 4),
      exponential_(n_, bands_),
      correction_({split_stages(1, n_)}),
      W0_single_(n_),
      mu_(n_),
      v_(n_),
      terms_(n_),
      mu_single_(n_),
      v_single_(n_),
      terms_single_(n_),
      Omega_single_(n_),
      c_(n_),
      next_c_(n_),
      D_(n_),
      BD_(n_),
      terms_of_D_(n_),
      Omega_cut_(n_) {
  moved_.fill(SingleMatrix(n_));
  inner_.fill(SingleMatrix(n_));
}

std::vector<Attempt> ExponentialSystem::attempts(bool newton) const {
  const Iteration first = newton ? Iteration::newton : Iteration::picard;
  return {{Start::predicted, first},
          {Start::stepped, first},
          {Start::cold, first},
          {Start::cold, Iteration::picard},
          {Start::cold, Iteration::anderson}};
}

void ExponentialSystem::bind(const SplitMatrix& W0, double h, double tolerance) {
  W0_ = &W0;
  h_ = h;
  tolerance_ = tolerance;
  size_of_W0_ = norm(W0);
  round_to_single(W0_single_, W0);
  bands_.truncate_symmetric_to_part(W0_single_, tuning.single_roundoff);
}

void ExponentialSystem::start(Unknowns& x, Start how) {
  SplitMatrix& Omega = x[0][0];
  if (how == Start::stepped) {
    single_lie_.neglect(tuning.single_roundoff);
    magnus_.form_exponent(Omega_single_, W0_single_, h_);
    widen(Omega, Omega_single_);
  } else {
    lie_.neglect(0.0);
    lie_.generate(Omega, *W0_);
    Omega = h_ * Omega;
  }
}

double ExponentialSystem::unit(const Unknowns& x) const {
  const double size = norm(x[0][0]);
  return size > 0.0 ? size : 1.0;
}

// Sets mu_ to φ₁(ad_Ω) W₀ with this error, and moved_ to e^{s ad_Ω} W₀ at all nodes.
bool ExponentialSystem::form_average(const SplitMatrix& Omega, double error) {
  mu_ = 1.0 * *W0_;
  for (SingleMatrix& moved : moved_) moved = 1.0 * W0_single_;
  series_.truncate(bands_, 0.1 * error);
  series_.begin(Omega, *W0_, error);
  bool goes_on = true;
  while (goes_on) {
    goes_on = series_.advance();
    if (series_.failed()) return false;
    const int k = series_.k();
    series_.add_to(mu_, 1.0 / static_cast<double>(k + 1));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      series_.add_to(moved_[i], std::pow(nodes[i].s, k));
    }
  }
  return true;
}

// Sets `terms` to the chosen ones and takes their size beside v_.
template <class Real>
void ExponentialSystem::form_terms(SplitMatrixOf<Real>& terms,
                                   SplitModifiedGradient<Real>& gradient,
                                   const SplitMatrixOf<Real>& mu, const SplitMatrixOf<Real>& v,
                                   typename SplitModifiedGradient<Real>::Terms which) {
  gradient.evaluate(terms, mu, v, h_, which);
  share_of_terms_[which.second ? 0 : 1] = norm(terms) / norm(v_);
}

// Sets v_ to B̃(mu_), to a relative accuracy.  The terms in h² and h⁴ are formed in single precision
// where its rounding does not show, by their last sizes.
void ExponentialSystem::form_gradient(double accuracy) {
  lie_.neglect(0.1 * accuracy);
  lie_.cut(mu_);
  lie_.generate(v_, mu_);
  if (order_ == 2) return;
  round_to_single(mu_single_, mu_);
  round_to_single(v_single_, v_);
  // The terms are small, and may err by a larger part of themselves.
  const bool has_fourth = order_ == 6;
  const double share = std::max(share_of_terms_[0], has_fourth ? share_of_terms_[1] : 0.0);
  const double of_terms = std::min(0.1 * accuracy / share, coarsest_part);
  lie_.neglect(of_terms);
  single_lie_.neglect(of_terms);
  single_lie_.cut(mu_single_);
  single_lie_.cut(v_single_);
  if (has_fourth && share_of_terms_ == unknown_shares) {  // to see its size alone
    form_terms(terms_single_, single_gradient_, mu_single_, v_single_,
               {.second = false, .fourth = true});
  }
  const auto may_be_single = [&](std::size_t term) {
    return tuning.single_roundoff * share_of_terms_[term] <= accuracy;
  };
  using Single = SplitModifiedGradient<float>::Terms;
  using Double = SplitModifiedGradient<double>::Terms;
  const Single in_single = {.second = may_be_single(0), .fourth = has_fourth && may_be_single(1)};
  const Double in_double = {.second = !in_single.second, .fourth = has_fourth && !in_single.fourth};
  const bool any_in_double = in_double.second || in_double.fourth;
  if (any_in_double) form_terms(terms_, gradient_, mu_, v_, in_double);
  if (in_single.second || in_single.fourth) {
    form_terms(terms_single_, single_gradient_, mu_single_, v_single_, in_single);
    add(v_, terms_single_);
  }
  if (any_in_double) v_ = v_ + terms_;
}

ResidualSize ExponentialSystem::residual(Corrections& R, Unknowns& x, double accuracy) {
  SplitMatrix& Omega = x[0][0];
  const double size = norm(Omega);
  const double relative = size > 0.0 ? accuracy / size : accuracy;
  bands_.truncate(x[0], 0.1 * accuracy);
  if (!form_average(Omega, error_of_average * relative * size_of_W0_)) {
    return {.change = std::numeric_limits<double>::quiet_NaN(), .neglected = 0.0};
  }
  form_gradient(relative);
  const double change = form_residual(
      R[0], [&](std::size_t) { return h_ * v_; }, x[0]);
  return {.change = change, .neglected = 0.5 * accuracy};
}

Correction ExponentialSystem::correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                                      const CorrectionRequest& request,
                                      const IterationOptions& options) {
  round_to_single(Omega_single_, x[0][0]);
  is_linearized_ = false;
  // K is needed to few digits, and its derivative of the term in h² to fewer.
  const double part =
      std::min(tuning.neumann_term * request.forcing_term / request.size, coarsest_part);
  single_lie_.cut_to_part(Omega_single_, part);
  for (SingleMatrix& moved : moved_) single_lie_.cut_to_part(moved, part);
  if (order_ > 2) {
    const double of_terms = std::min(part / part_in_K(share_of_terms_[0]), coarsest_part);
    single_lie_.cut_to_part(mu_single_, of_terms);
    single_lie_.cut_to_part(v_single_, of_terms);
  }
  Correction correction = correction_.solve(delta, *this, R, request, options);
  if (order_ == 6) {  // the derivative that K leaves out
    correction.error += part_in_K(share_of_terms_[1]) * request.size;
  }
  return correction;
}

// Estimates the part of δ that the derivative of terms of this share adds to K δ.  Newton replaces
// the estimate by what a correction was seen to leave, where that is more.
double ExponentialSystem::part_in_K(double share) {
  return 2.0 * std::min(share, 1.0) * contraction_of_K;
}

void ExponentialSystem::couple(Corrections& coupled, const Corrections& delta, double accuracy) {
  const SingleMatrix& t = delta[0][0];
  const double size = norm(t);
  single_lie_.neglect(std::max(accuracy / size, double{tuning.single_roundoff}));
  const bool one_node = error_of_one_node * contraction_of_K * size <= accuracy;
  const std::size_t first = one_node ? 0 : 1;
  const std::size_t count = one_node ? 1 : 2;
  c_ = 1.0 * t;
  single_lie_.cut(c_);
  for (std::size_t i = 0; i < count; ++i) inner_[i] = 1.0 * c_;
  constexpr int most_terms = 60;
  for (int j = 1; j < most_terms; ++j) {
    single_lie_.bracket(next_c_, Omega_single_, c_, 1.0 / static_cast<double>(j + 1));
    std::swap(c_, next_c_);
    for (std::size_t i = 0; i < count; ++i) {
      inner_[i] = inner_[i] + std::pow(nodes[first + i].s, j) * c_;
    }
    if (!(contraction_of_K * norm(c_) > accuracy)) break;
  }
  single_lie_.bracket(D_, inner_[0], moved_[first], nodes[first].weight);
  if (count == 2) {
    single_lie_.add_bracket(D_, inner_[1], moved_[first + 1], nodes[first + 1].weight);
  }
  single_lie_.generate(BD_, D_);
  SingleMatrix& out = coupled[0][0];
  if (order_ == 2 || part_in_K(share_of_terms_[0]) * size < accuracy) {
    out = h_ * BD_;
    return;
  }
  const double of_terms = accuracy / (part_in_K(share_of_terms_[0]) * size);
  single_lie_.neglect(std::min(of_terms, coarsest_part));
  if (!is_linearized_) single_gradient_.linearize(mu_single_, v_single_);
  is_linearized_ = true;
  single_gradient_.derivative_of_second(terms_of_D_, mu_single_, v_single_, D_, BD_, h_);
  out = h_ * BD_ + h_ * terms_of_D_;
}

void ExponentialSystem::update(SplitMatrix& W1, const Unknowns& x) {
  Omega_cut_ = 1.0 * x[0][0];
  bands_.truncate(Omega_cut_, 0.1 * tolerance_ * unit(x));
  if (!exponential_.conjugate(W1, Omega_cut_, *W0_, products_)) {
    W1.re()[0] = std::numeric_limits<double>::quiet_NaN();  // the step diverges
  }
}

}  // namespace isosyrk
