#include "isosyrk/solver/picard_iteration.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {

SolveReport PicardIteration::solve(FixedPointSystem& system, const IterationOptions& options,
                                   Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double unit = system.unit(x);
    const double accuracy = tuning.accepting_accuracy * options.tolerance;
    const double change = system.residual(R_, x, unit * accuracy).change;
    add(x, R_);
    return change / unit;
  });
}

SolveReport PicardIteration::solve_with_frozen_sweeps(FixedPointSystem& system,
                                                      const IterationOptions& options,
                                                      Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double unit = system.unit(x);
    const double accuracy = tuning.accepting_accuracy * options.tolerance;
    const double change = system.residual(R_, x, unit * accuracy).change;
    Correction correction;
    if (change >= unit * options.tolerance) {
      correction = system.correct(delta_, x, R_,
                                  {.size = change,
                                   .forcing_term = tuning.forcing_relative * change,
                                   .part = JacobianPart::frozen},
                                  options);
    }
    add(x, correction.usable ? delta_ : R_);
    return change / unit;
  });
}

}  // namespace isosyrk
