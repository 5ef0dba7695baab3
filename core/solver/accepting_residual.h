// The residual of a sweep that may be accepted.
#pragma once

#include "isosyrk/solver/fixed_point_system.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {

/// Sets R to the residual at x with the accuracy that acceptance to the tolerance needs.  Returns
/// its change, relative to the unit of the system.
inline double accepting_residual(Corrections& R, FixedPointSystem& system, Unknowns& x,
                                 double tolerance) {
  const double unit = system.unit(x);
  return system.residual(R, x, unit * tuning.accepting_accuracy * tolerance).change / unit;
}

}  // namespace isosyrk
