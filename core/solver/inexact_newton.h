// Inexact Newton and Picard iterations for x = G(x).
#pragma once

#include "isosyrk/iteration/status.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Solves x = G(x) to a tolerance on the change of a Picard sweep in double precision.  Corrections are
/// found in single precision: they take digits off the residual, and never decide that x is accepted.
///
/// Newton: with R = G(x) - x, the correction solves (1 - T - K) delta = R to a forcing term
/// (R. S. Dembo, S. C. Eisenstat, T. Steihaug, SIAM J. Numer. Anal. 19, 1982) by alternating frozen
/// sweeps and couplings.
///
/// Picard with frozen sweeps: x <- x + R, after frozen sweeps of R; T contracts slowly in the fine
/// scales, and one more application of it lets the iteration bear longer steps.
class InexactNewton {
 public:
  /// For unknowns of these shapes.  Allocates here only.
  explicit InexactNewton(const Unknowns& like);

  SolveReport newton(FixedPointSystem& system, const SolverOptions& options, Unknowns& x);
  SolveReport picard(FixedPointSystem& system, const SolverOptions& options, int frozen_sweeps,
                     Unknowns& x);

  /// Forgets the contraction last observed.
  void forget();

  /// Solves (1 - T - K) delta = R for a linearised-at-will system, ‖R‖ = `size`, until the estimated
  /// error of delta is below the forcing term, or the inner sweeps end.  False if the parts do not
  /// contract; delta is then of no use.
  bool correct(FixedPointSystem& system, const Corrections& R, double size, double tolerance);
  const Corrections& correction() const { return delta_; }

  Corrections& residual() { return R_; }

 private:
  Corrections R_, delta_, rhs_, coupled_;
  double contraction_;  // of a Picard sweep near the solution, as last observed
};

}  // namespace isosyrk
