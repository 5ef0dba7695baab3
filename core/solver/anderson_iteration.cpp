#include "isosyrk/solver/anderson_iteration.h"

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/accepting_residual.h"

namespace isosyrk {

SolveReport AndersonIteration::solve(FixedPointSystem& system, const IterationOptions& options,
                                     Unknowns& x) {
  anderson_.begin(x);
  return solve_fixed_point(options, [&] {
    const double change = accepting_residual(R_, system, x, options.tolerance);
    add(x, R_);
    if (change >= options.tolerance) anderson_.mix(x);
    return change;
  });
}

}  // namespace isosyrk
