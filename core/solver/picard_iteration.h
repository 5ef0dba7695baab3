// Picard iteration for x = G(x), plain or with frozen sweeps.
#pragma once

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Picard sweeps x <- G(x) in double precision, to a tolerance on their change.
///
/// With frozen sweeps: x <- x + delta, where delta starts as R and is improved by the part of the
/// Jacobian with B frozen.  That part contracts slowly in the fine scales; a further application of
/// it makes longer steps converge.
class PicardIteration {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit PicardIteration(const Unknowns& like) : R_(corrections_like(like)), delta_(R_) {}

  /// Solves from the given x, and returns how the iteration ended.
  SolveReport solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x);
  /// The same with frozen sweeps.
  SolveReport solve_with_frozen_sweeps(FixedPointSystem& system, const IterationOptions& options,
                                       Unknowns& x);

 private:
  Corrections R_, delta_;
};

}  // namespace isosyrk
