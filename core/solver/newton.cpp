#include "isosyrk/solver/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {
namespace {

// A start that errs by this many times what the one before did, errs in a way not seen before. Past
// steps may err by ten times what an explicit start does (Tuning::predicted_error).
constexpr double new_error = 16.0;

// The error that a correction of a residual of this size may have, given its least value.
double forcing_term(double size, double least) {
  return std::max({least, tuning.forcing_relative * size, tuning.forcing_quadratic * size * size});
}

}  // namespace

Newton::Newton(const Unknowns& like)
    : n_(like[0][0].size()), R_(corrections_like(like)), delta_(R_) {
  forget();
}

void Newton::forget() {
  contraction_ = tuning.likely_contraction;
  start_change_ = 0.0;
  left_by_correction_.reset();
}

void Newton::exchange_memory(Memory& other) {
  std::swap(contraction_, other.contraction);
  std::swap(start_change_, other.start_change);
  std::swap(left_by_correction_, other.left_by_correction);
}

// The contraction was seen in an earlier sweep, so that of the next is taken twice as large.
double Newton::first_factor() const { return std::min(1.0, 2.0 * contraction_); }

// What earlier steps have shown says nothing of the error of this one.
void Newton::distrust() {
  contraction_ = std::max(contraction_, tuning.likely_contraction);
  left_by_correction_.reset();
}

// The sweep now made multiplies the change by the first factor, each further one by the
// contraction.
bool Newton::sweeps_alone_converge(int sweeps, double change, double tolerance) const {
  return first_factor() * std::pow(contraction_, sweeps - 1) * change < tolerance;
}

SolveReport Newton::solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x) {
  const Acceptance rule = system.acceptance();
  const double tolerance = options.tolerance;
  const double accepting = rule.accepting_accuracy(tolerance);
  const double least_forcing = rule.least_forcing_term(tolerance);
  // Change of the last sweep if that was a Picard sweep near the solution, else 0.
  double near = 0.0;
  double far = 0.0;                 // the same of a Picard sweep far from it
  bool freezes = false;             // far from the solution Picard sweeps do not contract
  double expected = start_change_;  // change expected of the next sweep
  double corrected = 0.0;           // change of the last sweep if that was corrected, else 0
  double estimate = 0.0;            // of the error of x
  bool is_first = true;
  contraction_ = std::max(contraction_, system.least_contraction());
  const auto move = [&](const Correction& by) { add(x, by.usable ? delta_ : R_); };
  const auto sweep = [&] {
    const double unit = system.unit(x);
    // G need not be more accurate than the error that the correction will leave.
    double accuracy =
        expected > 0.0
            ? std::max(accepting, tuning.accepting_accuracy * forcing_term(expected, least_forcing))
            : accepting;
    ResidualSize size = system.residual(R_, x, unit * accuracy);
    if (size.change < unit * tolerance && size.neglected > unit * accepting) {
      size = system.residual(R_, x, unit * accepting);  // to be accepted, it must be complete
    }
    const double change = size.change / unit;
    if (is_first) {
      const bool is_new = !(change <= new_error * start_change_);  // NaN included
      if (is_new && rule.by == Acceptance::By::error_estimate) distrust();
      start_change_ = change;
    }
    is_first = false;
    if (near > 0.0) contraction_ = std::max(change / near, system.least_contraction());
    if (far > 0.0 && change >= far) freezes = true;
    if (corrected > 0.0) left_by_correction_ = change / corrected;
    const bool is_plain =
        sweeps_alone_converge(rule.sweeps_for_a_correction(n_), change, tolerance);
    const bool is_far = !is_plain && !(change <= tuning.largest_corrected);  // NaN included
    CorrectionRequest request = {.size = size.change,
                                 .forcing_term = unit * forcing_term(change, least_forcing)};
    Correction correction;
    if (is_far && freezes) {
      request.part = JacobianPart::frozen;
      move(system.correct(delta_, x, R_, request, options));
    } else {
      if (!is_far && !is_plain) correction = system.correct(delta_, x, R_, request, options);
      move(correction);
    }
    near = is_far || correction.usable ? 0.0 : change;
    far = is_far && !freezes ? change : 0.0;
    corrected = correction.usable ? change : 0.0;
    const double left = tuning.forcing_quadratic * change * change;  // by the Jacobian's change
    expected = correction.usable ? std::max(correction.error / unit, left) : contraction_ * change;
    if (is_plain) {
      estimate = first_factor() * change + size.neglected / unit;
    } else if (correction.usable) {
      estimate = std::max((correction.error + size.neglected) / unit + left,
                          left_by_correction_.value_or(0.0) * change);
    } else {
      estimate = std::numeric_limits<double>::quiet_NaN();
    }
    return change;
  };
  return solve_fixed_point(options, sweep, [&](double change) {
    return rule.accepts(
        {.change = change, .error = estimate, .is_confirmed = left_by_correction_.has_value()},
        tolerance);
  });
}

}  // namespace isosyrk
