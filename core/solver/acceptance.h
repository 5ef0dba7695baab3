// When a solver accepts x as the solution of x = G(x).
#pragma once

#include "isosyrk/solver/tuning.h"

namespace isosyrk {

/// Rule of acceptance of an iteration with corrections.  All sizes are relative to the unit of the
/// system.
struct Acceptance {
  enum class By {
    change,         ///< the change of a Picard sweep is below the tolerance, as in published forms
    error_estimate  ///< the estimated error of x after a correction is below the tolerance
  };
  By by = By::change;
  /// An estimate is believed only after a residual below this: far from the solution, R and the
  /// Jacobian say nothing of the error.
  double guard = 1e-5;
  /// The same where a correction of an earlier step was seen to leave what is estimated now.
  double confirmed_guard = 1e-3;

  /// A sweep that is about to move x.
  struct Sweep {
    double change;      ///< norm of R
    double error;       ///< estimated error of x moved; NaN if unknown
    bool is_confirmed;  ///< the estimate is that of a correction seen before
  };
  /// True if x is accepted once it is moved.
  bool accepts(const Sweep& sweep, double tolerance) const {
    if (sweep.change < tolerance) return true;
    const double largest = sweep.is_confirmed ? confirmed_guard : guard;
    return by == By::error_estimate && sweep.change < largest && sweep.error < tolerance;
  }
  /// Returns the number of Picard sweeps that are taken in place of a correction where they
  /// converge.
  int sweeps_for_a_correction(Index n) const {
    return by == By::error_estimate ? 1 : tuning.sweeps_for_a_correction(n);
  }
  /// Returns the accuracy of the residual of a sweep that may be accepted.
  double accepting_accuracy(double tolerance) const {
    return tolerance * (by == By::error_estimate ? tuning.accepting_accuracy_of_estimate
                                                 : tuning.accepting_accuracy);
  }
  /// Returns the least forcing term of a correction: no correction has to err less.
  double least_forcing_term(double tolerance) const {
    return tolerance *
           (by == By::error_estimate ? tuning.forcing_of_estimate : tuning.forcing_of_tolerance);
  }
};

}  // namespace isosyrk
