#include "isosyrk/solver/picard_iteration.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/accepting_residual.h"

namespace isosyrk {

SolveReport PicardIteration::solve(FixedPointSystem& system, const IterationOptions& options,
                                   Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double change = accepting_residual(R_, system, x, options.tolerance);
    add(x, R_);
    return change;
  });
}

SolveReport PicardIteration::solve_with_frozen_sweeps(FixedPointSystem& system,
                                                      const IterationOptions& options,
                                                      Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double change = accepting_residual(R_, system, x, options.tolerance);
    Correction correction;
    if (change >= options.tolerance) {
      const double size = change * system.unit(x);
      correction = system.correct(delta_, x, R_,
                                  {.size = size,
                                   .forcing_term = tuning.forcing_relative * size,
                                   .part = JacobianPart::frozen},
                                  options);
    }
    add(x, correction.usable ? delta_ : R_);
    return change;
  });
}

}  // namespace isosyrk
