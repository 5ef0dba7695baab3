// The trace of a state.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the c of the part icI of a skew-Hermitian W, Im tr W / n, rounded once.  0 if |c| is at
/// most ε ‖W‖_F, with ε the distance from 1 to the next number: the rounding of W makes as much of
/// a trace.  0, too, if W is not finite.
double trace_part(const ConstMatrixView& W);

}  // namespace isosyrk
