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
  lie_.neglect(part_of_first * wanted.accuracy);
  lie_.cut(mu);
  lie_.generate(v, mu);
  if (!all_.any()) return;
  terms_ = Omega - h * v;  // about h times their sum
  sizes_.begin(v, mu, h, wanted.accuracy, wanted.least, norm(terms_) / std::abs(h));
  double part = cut(v, mu);
  form(v, mu, h);
  constexpr int most_repeats = 2;  // a term may vanish in what was cut, and in single precision
  for (int k = 0; k < most_repeats && !suffices(part); ++k) {
    part = cut(v, mu);
    form(v, mu, h);
  }
  if (in_single_.any()) add(v, terms_single_);
  if (in_double_.any()) v = v + terms_;
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
bool GradedGradient::suffices(double part) const {
  return sizes_.allow_rounding(in_single_) && (!lie_.cuts() || sizes_.allow_cut(part));
}

// Forms the terms, each in the precision that it needs.
void GradedGradient::form(const SplitMatrix& v, const SplitMatrix& mu, double h) {
  in_single_ = sizes_.in_single();
  in_double_ = all_ - in_single_;
  if (in_double_.any()) {
    gradient_.evaluate(terms_, mu, v, h, {in_double_.second, in_double_.fourth});
    sizes_.record(in_double_, norm(terms_));
  }
  if (in_single_.any()) {
    single_gradient_.evaluate(terms_single_, mu_, v_, h, {in_single_.second, in_single_.fourth});
    sizes_.record(in_single_, norm(terms_single_));
    is_linearized_ = true;
  }
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
