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

SolveReport PicardIteration::solve_by_far_sweeps(FixedPointSystem& system,
                                                 const IterationOptions& options, Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double change = accepting_residual(R_, system, x, options.tolerance);
    if (change >= options.tolerance) {
      system.far_sweep(delta_, x, R_, options);
      add(x, delta_);
    } else {  // NaN included
      add(x, R_);
    }
    return change;
  });
}

}  // namespace isosyrk
