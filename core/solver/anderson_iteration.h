// Picard iteration with Anderson acceleration for x = G(x).
#pragma once

#include "isosyrk/solver/anderson.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Picard sweeps in double precision, each mixed with those before it (Anderson), to a tolerance on
/// the change of a sweep before it is mixed.
class AndersonIteration {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit AndersonIteration(const Unknowns& like) : R_(corrections_like(like)), anderson_(like) {}

  /// Solves from the given x, and returns how the iteration ended.
  SolveReport solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x);

 private:
  Corrections R_;
  Anderson anderson_;
};

}  // namespace isosyrk
