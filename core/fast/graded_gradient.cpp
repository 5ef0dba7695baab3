#include "isosyrk/fast/graded_gradient.h"

#include <cmath>

#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// Part of the accuracy that may be cut from B(μ).
constexpr double part_of_first = 0.1;

}  // namespace

GradedGradient::GradedGradient(SplitLie<double>& lie, SplitLie<float>& single_lie, Index n,
                               int order)
    : lie_(lie),
      single_lie_(single_lie),
      all_{.second = order > 2, .fourth = order > 4},
      sizes_(all_),
      gradient_(lie, order),
      single_gradient_(single_lie, order),
      mu_(n),
      v_(n),
      terms_(n),
      terms_single_(n) {}

void GradedGradient::evaluate(SplitMatrix& v, SplitMatrix& mu, const SplitMatrix& Omega,
                              const Wanted& wanted) {
  const double h = wanted.h;
  is_linearized_ = false;
  held_ = held_in_single_ = {};
  lie_.neglect(part_of_first * wanted.accuracy);
  lie_.cut(mu);
  lie_.generate(v, mu);
  if (!all_.any()) return;
  sizes_.begin(v, mu, h, wanted.accuracy, wanted.least, wanted.shares);
  if (sizes_.are_known()) {
    form_terms(all_, v, mu, h, cut(v, mu));
  } else {
    terms_ = Omega - h * v;  // about h times their sum
    sizes_.guess(norm(terms_) / std::abs(h));
    const double part = cut(v, mu);
    GradientTerms which = all_;
    if (all_.fourth) which.fourth = !form_fourth_alone(h, part);
    sizes_.set_known();
    form_terms(which, v, mu, h, part);
  }
  if (held_in_single_.any()) add(v, terms_single_);
  if (held_.any()) v = v + terms_;
}

// Forms these terms from what is cut by `part`, and all of them again, from what is cut anew, where
// one turns out larger than was expected.
void GradedGradient::form_terms(GradientTerms which, const SplitMatrix& v, const SplitMatrix& mu,
                                double h, double part) {
  form(which, v, mu, h);
  constexpr int most_repeats = 2;  // a term may vanish in what was cut, and in single precision
  for (int k = 0; k < most_repeats && !suffices(held_in_single_, part); ++k) {
    part = cut(v, mu);
    form(all_, v, mu, h);
  }
}

// Keeps μ and v, rounded and cut, for the terms in single precision and for the derivative.
// Returns the part that all that the terms are made of is cut by.
double GradedGradient::cut(const SplitMatrix& v, const SplitMatrix& mu) {
  const double part = sizes_.part_to_cut();
  lie_.neglect(part);
  single_lie_.neglect(part);
  round_to_single(mu_, mu);
  round_to_single(v_, v);
  single_lie_.cut(mu_);
  single_lie_.cut(v_);
  return part;
}

// True if the sizes as recorded allow what was formed in single precision, and from what was cut.
bool GradedGradient::suffices(GradientTerms in_single, double part) const {
  return sizes_.allow_rounding(in_single) && (!lie_.cuts() || sizes_.allow_cut(part));
}

// Forms the term in h⁴ by itself, to see its size.  True if it may be used.
bool GradedGradient::form_fourth_alone(double h, double part) {
  constexpr GradientTerms fourth = {.second = false, .fourth = true};
  form_in_single(fourth, h);
  const GradientTerms in_single = sizes_.in_single(all_);
  if (!in_single.second || !in_single.fourth || !suffices(fourth, part)) return false;
  widen(terms_, terms_single_);
  held_ = fourth;
  return true;
}

// Forms these terms, each in the precision that it needs.
void GradedGradient::form(GradientTerms which, const SplitMatrix& v, const SplitMatrix& mu,
                          double h) {
  held_in_single_ = sizes_.in_single(which);
  const GradientTerms in_double = which - held_in_single_;
  held_ = held_ - which;
  if (in_double.any()) {
    gradient_.evaluate(terms_, mu, v, h, {in_double.second, in_double.fourth});
    sizes_.record(in_double, norm(terms_));
    held_ = in_double;
  }
  if (held_in_single_.any()) form_in_single(held_in_single_, h);
}

void GradedGradient::form_in_single(GradientTerms which, double h) {
  single_gradient_.evaluate(terms_single_, mu_, v_, h, {which.second, which.fourth});
  sizes_.record(which, norm(terms_single_));
  is_linearized_ = true;
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
