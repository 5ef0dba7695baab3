// The interface between solvers and equations x = G(x).
#pragma once

#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/iteration/status.h"
#include "isosyrk/solver/convergence_test.h"
#include "isosyrk/solver/corrections.h"
#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// A system x = G(x).  A solver knows no more of it than this.
class FixedPointSystem {
 public:
  virtual ~FixedPointSystem() = default;

  /// Sets R = G(x) - x, formed in double and rounded to single precision.  May truncate x to its
  /// bands, and neglect terms of G(x) that are `accuracy` together.
  virtual ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) = 0;

  /// Sets delta to a solution of (1 - G'(x)) delta = R, where x and R are those of the last
  /// residual().  The system chooses how: see AlternatingCorrection and NeumannCorrection.
  /// options.after_sweep is called after each of its inner sweeps.
  virtual Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                             const CorrectionRequest& request, const IterationOptions& options) = 0;

  /// Sets delta to what x moves by far from the solution, where Picard sweeps do not contract and a
  /// correction is of no use.  R itself, if the system has nothing better.
  virtual void far_sweep(Corrections& delta, const Unknowns&, const Corrections& R,
                         const IterationOptions&) {
    copy(delta, R);
  }

  /// Returns the size of x to which the tolerance is relative.
  virtual double unit(const Unknowns&) const { return 1.0; }

  /// Returns the test of an iteration from x to the tolerance: by the change of a sweep, as in
  /// published forms, unless the system has another one.
  virtual ConvergenceTest convergence_test(const Unknowns& x, double tolerance,
                                           IterationMemory& memory) const {
    return ConvergenceTest({}, tolerance, x[0][0].size(), 0.0, memory);
  }
};

}  // namespace isosyrk
