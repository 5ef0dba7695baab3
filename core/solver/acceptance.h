// When a solver accepts x as the solution of x = G(x).
#pragma once

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

  /// True if x, about to be moved by R or a correction of it, is then accepted.  `change` is the
  /// norm of R, `estimate` the estimated error of the corrected x, NaN if there is no correction.
  bool accepts(double change, double estimate, double tolerance) const {
    if (change < tolerance) return true;
    return by == By::error_estimate && change < guard && estimate < tolerance;
  }
};

}  // namespace isosyrk
