#include "isosyrk/solver/anderson_iteration.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {

SolveReport AndersonIteration::solve(FixedPointSystem& system, const IterationOptions& options,
                                     Unknowns& x) {
  anderson_.begin(x);
  return solve_fixed_point(options, [&] {
    const double unit = system.unit(x);
    const double accuracy = tuning.accepting_accuracy * options.tolerance;
    const double change = system.residual(R_, x, unit * accuracy).change;
    add(x, R_);
    if (change >= unit * options.tolerance) anderson_.mix(x);
    return change / unit;
  });
}

}  // namespace isosyrk
