// Inexact Newton iteration for x = G(x).
#pragma once

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Inexact Newton: with R = G(x) - x, x moves by a correction delta that solves (1 - G') delta = R
/// to a forcing term, or by R where no correction pays or is usable.  Corrections are computed in
/// single precision.  They reduce the residual, and enter the acceptance test only where the system
/// says so.  Accuracies, forcing terms and the end are those of the system's ConvergenceTest.
/// Source: R. S. Dembo, S. C. Eisenstat, T. Steihaug, SIAM J. Numer. Anal. 19, 1982.
class Newton {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit Newton(const Unknowns& like) : R_(corrections_like(like)), delta_(R_) {}

  /// Solves from the given x, and returns how the iteration ended.  The memory is that of earlier
  /// iterations for such an x.
  SolveReport solve(FixedPointSystem& system, IterationMemory& memory,
                    const IterationOptions& options, Unknowns& x);

 private:
  Corrections R_, delta_;
};

}  // namespace isosyrk
