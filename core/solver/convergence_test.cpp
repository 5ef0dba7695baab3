#include "isosyrk/solver/convergence_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isosyrk {
namespace {

// A start that errs by this many times what the one before did, errs in a way not seen before. Past
// steps may err by ten times what an explicit start does (StartChoice).
constexpr double new_error = 16.0;

}  // namespace

ConvergenceTest::ConvergenceTest(const Acceptance& rule, double tolerance, Index n,
                                 double least_contraction, IterationMemory& memory)
    : rule_(rule),
      tolerance_(tolerance),
      sweeps_for_a_correction_(rule.sweeps_for_a_correction(n)),
      least_contraction_(least_contraction),
      memory_(memory) {
  memory_.contraction = std::max(memory_.contraction, least_contraction);
}

double ConvergenceTest::forcing_term() const {
  return unit_ * std::max({rule_.least_forcing_term(tolerance_), tuning.forcing_relative * change_,
                           tuning.forcing_quadratic * change_ * change_});
}

ConvergenceTest::Move ConvergenceTest::judge(const ResidualSize& size) {
  size_ = size;
  change_ = size.change / unit_;
  learn();
  is_plain_ = sweeps_alone_converge();
  is_far_ = !is_plain_ && !(change_ <= tuning.largest_corrected);  // NaN included
  if (is_far_ && stalls_) return Move::far;
  return is_far_ || is_plain_ ? Move::picard : Move::correction;
}

// Learns from the change of this sweep what the one before it has done.
void ConvergenceTest::learn() {
  if (is_first_) {
    const bool is_new = !(change_ <= new_error * memory_.start_change);  // NaN included
    if (is_new && rule_.by == Acceptance::By::error_estimate) distrust();
    memory_.start_change = change_;
    is_first_ = false;
  }
  if (near_ > 0.0) memory_.contraction = std::max(change_ / near_, least_contraction_);
  if (far_ > 0.0 && change_ >= far_) stalls_ = true;
  if (corrected_ > 0.0) memory_.left_by_correction = change_ / corrected_;
}

// What earlier steps have shown says nothing of the error of this one.
void ConvergenceTest::distrust() {
  memory_.contraction = std::max(memory_.contraction, tuning.likely_contraction);
  memory_.left_by_correction.reset();
}

// The contraction was seen in an earlier sweep, so that of the next is taken twice as large.
double ConvergenceTest::first_factor() const { return std::min(1.0, 2.0 * memory_.contraction); }

// The sweep now made multiplies the change by the first factor, each further one by the
// contraction.
bool ConvergenceTest::sweeps_alone_converge() const {
  const double of_further = std::pow(memory_.contraction, sweeps_for_a_correction_ - 1);
  return first_factor() * of_further * change_ < tolerance_;
}

void ConvergenceTest::after_move(const Correction& correction) {
  const bool is_corrected = correction.usable;
  near_ = is_far_ || is_corrected ? 0.0 : change_;
  far_ = is_far_ && !stalls_ ? change_ : 0.0;
  corrected_ = is_corrected ? change_ : 0.0;
  const double left = tuning.forcing_quadratic * change_ * change_;  // by the Jacobian's change
  if (is_corrected) {
    estimate_ = std::max((correction.error + size_.neglected) / unit_ + left,
                         memory_.left_by_correction.value_or(0.0) * change_);
  } else {
    estimate_ = is_plain_ ? first_factor() * change_ + size_.neglected / unit_
                          : std::numeric_limits<double>::quiet_NaN();
  }
}

bool ConvergenceTest::accepts() const {
  return rule_.accepts({.change = change_,
                        .error = estimate_,
                        .is_confirmed = memory_.left_by_correction.has_value()},
                       tolerance_);
}

}  // namespace isosyrk
