// Picard iteration for x = G(x), plain or with the sweeps of a system far from the solution.
#pragma once

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Picard sweeps x <- G(x) in double precision, or the sweeps that a system has for x far from the
/// solution (FixedPointSystem::far_sweep), to a tolerance on the change of a Picard sweep.
class PicardIteration {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit PicardIteration(const Unknowns& like) : R_(corrections_like(like)), delta_(R_) {}

  /// Solves from the given x, and returns how the iteration ended.
  SolveReport solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x);
  /// The same with far sweeps.
  SolveReport solve_by_far_sweeps(FixedPointSystem& system, const IterationOptions& options,
                                  Unknowns& x);

 private:
  Corrections R_, delta_;
};

}  // namespace isosyrk
