#include "isosyrk/fast/term_sizes.h"

#include <algorithm>

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
// An error of a term may turn out this many times as large as was expected.
constexpr double slack = 4.0;

constexpr std::size_t second = 0, fourth = 1;

double at_most_one(double share) { return share < 1.0 ? share : 1.0; }  // 1 for NaN

}  // namespace

void TermSizes::begin(const SplitMatrix& v, const SplitMatrix& mu, double h, double accuracy,
                      double least, double guess) {
  accuracy_ = accuracy;
  const double size_of_v = norm(v);
  const double size_of_mu = norm(mu);
  whole_ = std::max(size_of_v, least);
  const double unit = h * h * size_of_v / (static_cast<double>(mu.size()) * whole_);
  const double of_mu = unit * size_of_mu * size_of_mu;
  const double of_v = unit * size_of_v * size_of_v;
  const double of_larger =
      std::max(of_mu, of_v);  // B damps rounding less than it damps fine scales
  typical_[second] = typical_share * of_mu;
  typical_[fourth] = fourth_beside_second * of_mu * typical_[second];
  shares_[second] = at_most_one(guess / whole_);
  shares_[fourth] = at_most_one(fourth_beside_second * of_mu * shares_[second]);
  rounded_[second] = rounding_of_bracket * unit * size_of_v * size_of_mu;
  rounded_[fourth] = fourth_beside_second * of_larger * rounded_[second];
  of_derivative_ = fourth_beside_second * typical_share * of_larger * of_larger;
}

void TermSizes::record(GradientTerms which, double norm) {
  shares_[which.second ? second : fourth] = at_most_one(norm / whole_);
}

GradientTerms TermSizes::in_single() const {
  return {.second = all_.second && is_single(second), .fourth = all_.fourth && is_single(fourth)};
}

// True if the rounding of single precision does not show in a term.
bool TermSizes::is_single(std::size_t term) const {
  return tuning.single_roundoff * std::max(shares_[term], rounded_[term]) <= accuracy_;
}

double TermSizes::part_to_cut() const {
  const double share = std::max(share_of_second(), all_.fourth ? share_of_fourth() : 0.0);
  return part_of_cuts * accuracy_ / share;
}

bool TermSizes::allow_rounding(GradientTerms in_single) const {
  return (!in_single.second || rounds_well(second)) && (!in_single.fourth || rounds_well(fourth));
}

bool TermSizes::rounds_well(std::size_t term) const {
  return tuning.single_roundoff * shares_[term] <= slack * accuracy_;
}

bool TermSizes::allow_cut(double part) const { return part <= slack * part_to_cut(); }

double TermSizes::share_of_second() const { return std::max(shares_[second], typical_[second]); }

double TermSizes::share_of_fourth() const { return std::max(shares_[fourth], typical_[fourth]); }

double TermSizes::share_of_derivative_of_fourth() const {
  return std::max(shares_[fourth], of_derivative_);
}

}  // namespace isosyrk
