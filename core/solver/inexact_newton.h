// Inexact Newton and Picard iterations for x = G(x).
#pragma once

#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/iteration/status.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Solves x = G(x) to a tolerance on the change of a Picard sweep in double precision.  Corrections
/// are computed in single precision.  They reduce the residual but do not enter the acceptance
/// test.
///
/// Inexact Newton: with R = G(x) - x, the correction solves (1 - T - K) delta = R to a forcing term
/// by alternating frozen sweeps and couplings.  If the last observed contraction predicts that one
/// Picard sweep converges, no correction is computed.
/// Source: R. S. Dembo, S. C. Eisenstat, T. Steihaug, SIAM J. Numer. Anal. 19, 1982.
///
/// Picard with frozen sweeps: x <- x + delta, where delta starts as R and is improved by frozen
/// sweeps with right-hand side R.  T contracts slowly in the fine scales; a further application of
/// T makes longer steps converge.
class InexactNewton {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit InexactNewton(const Unknowns& like);

  /// Solves by inexact Newton from the given x, and returns how the iteration ended.
  SolveReport newton(FixedPointSystem& system, const IterationOptions& options, Unknowns& x);
  /// Solves by Picard sweeps, each followed by `frozen_sweeps` frozen sweeps, from the given x.
  SolveReport picard(FixedPointSystem& system, const IterationOptions& options, int frozen_sweeps,
                     Unknowns& x);

  /// Forgets the last observed contraction.
  void forget();

  /// Linearises the system at the x of its last residual and solves (1 - T - K) delta = R, where
  /// `size` is the norm of R.  Ends when the estimated error of delta is below the forcing term, or
  /// after Tuning::inner_sweeps.  Returns false, with delta unspecified, if the iteration does not
  /// contract.
  bool correct(FixedPointSystem& system, const Corrections& R, double size,
               const IterationOptions& options);
  /// Returns the delta of the last correct().
  const Corrections& correction() const { return delta_; }

  /// Workspace for a residual, also for callers.
  Corrections& residual() { return R_; }

 private:
  int sweeps_;  // as Tuning::sweeps_for_a_correction
  Corrections R_, delta_, rhs_, coupled_;
  double contraction_;  // last observed, of a Picard sweep near the solution
};

}  // namespace isosyrk
