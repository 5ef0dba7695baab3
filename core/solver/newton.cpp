#include "isosyrk/solver/newton.h"

#include "isosyrk/iteration/picard.h"

namespace isosyrk {

SolveReport Newton::solve(FixedPointSystem& system, IterationMemory& memory,
                          const IterationOptions& options, Unknowns& x) {
  ConvergenceTest test = system.convergence_test(x, options.tolerance, memory);
  const auto sweep = [&] {
    test.begin_sweep(system.unit(x));
    const ResidualSize size = system.residual(R_, x, test.accuracy());
    Correction correction;
    switch (test.judge(size)) {
      case ConvergenceTest::Move::picard:
        add(x, R_);
        break;
      case ConvergenceTest::Move::far:
        system.far_sweep(delta_, x, R_, options);
        add(x, delta_);
        break;
      case ConvergenceTest::Move::correction:
        correction = system.correct(
            delta_, x, R_, {.size = size.change, .forcing_term = test.forcing_term()}, options);
        add(x, correction.usable ? delta_ : R_);
        break;
    }
    test.after_move(correction);
    return test.change();
  };
  return solve_fixed_point(options, sweep, [&](double) { return test.accepts(); });
}

}  // namespace isosyrk
