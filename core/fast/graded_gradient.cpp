#include "isosyrk/fast/graded_gradient.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// Part of h² ‖v‖ ‖μ‖ / n that counts for the rounding of the term in h².  With a quarter of the
// error that rounding was seen to make, that error may be four times the accuracy, which is a fifth
// of the tolerance; and the criterion moves no product of smooth and rough scenes at the tolerances
// in use.
constexpr double rounding_of_bracket = 0.01;
// Least part of h² ‖μ‖² / n that the term in h² is in a state without symmetry.
constexpr double typical_share = 0.01;
// The same parts of the term in h⁴, beside those of the term in h², are this times h² ‖μ‖² / n, and
// for rounding times h² ‖v‖² / n where that is more.
constexpr double fourth_beside_second = 0.1;
// What is cut may change a term by this part of the accuracy.
constexpr double part_of_cuts = 0.1;
// Largest part that is cut from a matrix, however few digits are wanted (ExponentialSystem).
constexpr double coarsest_part = 1e-2;
// An error of a term may turn out this many times as large as was expected.
constexpr double slack = 4.0;

}  // namespace

GradedGradient::GradedGradient(SplitLie<double>& lie, SplitLie<float>& single_lie, Index n,
                               int order)
    : lie_(lie),
      single_lie_(single_lie),
      order_(order),
      gradient_(lie, order == 6),
      single_gradient_(single_lie, order == 6),
      mu_(n),
      v_(n),
      terms_(n),
      terms_single_(n) {}

void GradedGradient::evaluate(SplitMatrix& v, SplitMatrix& mu, const SplitMatrix& Omega, double h,
                              double accuracy, double least) {
  accuracy_ = accuracy;
  lie_.neglect(0.1 * accuracy);
  lie_.cut(mu);
  lie_.generate(v, mu);
  if (order_ == 2) return;
  measure(v, mu, h, least);
  if (!knows_shares_) {
    terms_ = Omega - h * v;
    const double share = norm(terms_) / std::abs(h) / whole_;
    shares_.fill(share < 1.0 ? share : 1.0);  // 1 for NaN
  }
  is_linearized_ = false;
  double part = part_to_cut();
  round_and_cut(v, mu, part);
  const bool has_fourth = order_ == 6;
  bool is_fourth_formed = false;
  if (has_fourth && !knows_shares_) {  // alone, to see its size
    const Terms fourth = {.second = false, .fourth = true};
    form_in_single(fourth, h);
    is_fourth_formed = is_single(0) && is_single(1) && suffices(fourth, part);
    if (is_fourth_formed) widen(terms_, terms_single_);
  }
  knows_shares_ = true;
  constexpr int most_tries = 3;  // a term may vanish in what was cut, and again in single precision
  Terms in_single = {}, in_double = {};
  for (int tries = 1; tries <= most_tries; ++tries) {
    if (tries > 1) {
      part = part_to_cut();
      round_and_cut(v, mu, part);
      is_fourth_formed = false;
    }
    const bool forms_fourth = has_fourth && !is_fourth_formed;
    in_single = {.second = is_single(0), .fourth = forms_fourth && is_single(1)};
    in_double = {.second = !in_single.second, .fourth = forms_fourth && !in_single.fourth};
    if (in_double.any()) form_in_double(in_double, v, mu, h);
    if (in_single.any()) form_in_single(in_single, h);
    if (suffices(in_single, part)) break;
  }
  if (in_single.any()) add(v, terms_single_);
  if (in_double.any() || is_fourth_formed) v = v + terms_;
}

// Takes the sizes of what the terms are made of.
void GradedGradient::measure(const SplitMatrix& v, const SplitMatrix& mu, double h, double least) {
  const double size_of_v = norm(v);
  const double size_of_mu = norm(mu);
  whole_ = std::max(size_of_v, least);
  const double unit = h * h * size_of_v / (static_cast<double>(mu.size()) * whole_);
  const double of_mu = unit * size_of_mu * size_of_mu;
  const double of_v = unit * size_of_v * size_of_v;
  const double of_larger =
      std::max(of_mu, of_v);  // B damps rounding less than it damps fine scales
  typical_[0] = typical_share * of_mu;
  typical_[1] = fourth_beside_second * of_mu * typical_[0];
  rounded_[0] = rounding_of_bracket * unit * size_of_v * size_of_mu;
  of_derivative_ = fourth_beside_second * typical_share * of_larger * of_larger;
  rounded_[1] = fourth_beside_second * of_larger * rounded_[0];
}

// True if the rounding of single precision does not show in a term.
bool GradedGradient::is_single(std::size_t term) const {
  return tuning.single_roundoff * std::max(shares_[term], rounded_[term]) <= accuracy_;
}

// Returns the part that may be cut from each matrix that the terms are made of.
double GradedGradient::part_to_cut() const {
  const double share = std::max(share_of_second(), order_ == 6 ? share_of_fourth() : 0.0);
  return std::min(part_of_cuts * accuracy_ / share, coarsest_part);
}

// True if the sizes that were seen allow what was formed in single precision, and what was cut.
bool GradedGradient::suffices(Terms in_single, double part) const {
  const auto rounds_well = [&](std::size_t term) {
    return tuning.single_roundoff * shares_[term] <= slack * accuracy_;
  };
  return (!in_single.second || rounds_well(0)) && (!in_single.fourth || rounds_well(1)) &&
         (!lie_.cuts() || part <= slack * part_to_cut());
}

// Keeps μ and v, rounded and cut, for the terms in single precision and for the derivative.
void GradedGradient::round_and_cut(const SplitMatrix& v, const SplitMatrix& mu, double part) {
  lie_.neglect(part);
  single_lie_.neglect(part);
  round_to_single(mu_, mu);
  round_to_single(v_, v);
  single_lie_.cut(mu_);
  single_lie_.cut(v_);
}

void GradedGradient::form_in_single(Terms which, double h) {
  single_gradient_.evaluate(terms_single_, mu_, v_, h, {which.second, which.fourth});
  const double share = norm(terms_single_) / whole_;
  shares_[which.second ? 0 : 1] = share < 1.0 ? share : 1.0;
  is_linearized_ = true;
}

void GradedGradient::form_in_double(Terms which, const SplitMatrix& v, const SplitMatrix& mu,
                                    double h) {
  gradient_.evaluate(terms_, mu, v, h, {which.second, which.fourth});
  const double share = norm(terms_) / whole_;
  shares_[which.second ? 0 : 1] = share < 1.0 ? share : 1.0;
}

void GradedGradient::derivative_of_second(SingleMatrix& out, const SingleMatrix& D,
                                          const SingleMatrix& BD, double h) {
  single_lie_.cut(mu_);
  single_lie_.cut(v_);
  if (!is_linearized_) single_gradient_.linearize(mu_, v_);
  is_linearized_ = true;
  single_gradient_.derivative_of_second(out, mu_, v_, D, BD, h);
}

}  // namespace isosyrk
