#include "isosyrk/solver/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {
namespace {

// The error that a correction of a residual of this size may have.
double forcing_term(double size, double tolerance) {
  return std::max({tuning.forcing_of_tolerance * tolerance, tuning.forcing_relative * size,
                   tuning.forcing_quadratic * size * size});
}

}  // namespace

Newton::Newton(const Unknowns& like)
    : sweeps_(tuning.sweeps_for_a_correction(like[0][0].size())),
      R_(corrections_like(like)),
      delta_(R_) {
  forget();
}

void Newton::forget() {
  contraction_ = tuning.likely_contraction;
  start_change_ = 0.0;
}

// The sweep now made multiplies the change by the contraction, and so does each further one.  The
// contraction was seen in an earlier sweep: the first factor is taken twice as large, at most 1.
bool Newton::sweeps_alone_converge(double change, double tolerance) const {
  const double first = std::min(1.0, 2.0 * contraction_);
  return first * std::pow(contraction_, sweeps_ - 1) * change < tolerance;
}

SolveReport Newton::solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x) {
  const Acceptance rule = system.acceptance();
  const double tolerance = options.tolerance;
  const double accepting = tuning.accepting_accuracy * tolerance;
  double uncorrected = 0.0;         // change of the last sweep if that was a Picard sweep, else 0
  double expected = start_change_;  // change expected of the next sweep
  double estimate = 0.0;            // of the error of x
  bool is_first = true;
  const auto sweep = [&] {
    const double unit = system.unit(x);
    // G need not be more accurate than the error that the correction will leave.
    double accuracy =
        expected > 0.0
            ? std::max(accepting, tuning.accepting_accuracy * forcing_term(expected, tolerance))
            : accepting;
    ResidualSize size = system.residual(R_, x, unit * accuracy);
    if (size.change < unit * tolerance && size.neglected > unit * accepting) {
      size = system.residual(R_, x, unit * accepting);  // to be accepted, it must be complete
    }
    const double change = size.change / unit;
    if (is_first) start_change_ = change;
    is_first = false;
    if (uncorrected > 0.0) contraction_ = change / uncorrected;
    const bool is_plain = sweeps_alone_converge(change, tolerance);
    Correction correction;
    if (!is_plain && change <= tuning.largest_corrected) {
      correction = system.correct(
          delta_, x, R_,
          {.size = size.change, .forcing_term = unit * forcing_term(change, tolerance)}, options);
    }
    uncorrected = is_plain ? change : 0.0;
    add(x, correction.usable ? delta_ : R_);
    const double left = tuning.forcing_quadratic * change * change;  // by the Jacobian's change
    expected = correction.usable ? std::max(correction.error / unit, left) : contraction_ * change;
    estimate = correction.usable ? (correction.error + size.neglected) / unit + left
                                 : std::numeric_limits<double>::quiet_NaN();
    return change;
  };
  return solve_fixed_point(
      options, sweep, [&](double change) { return rule.accepts(change, estimate, tolerance); });
}

}  // namespace isosyrk
