// The trace of a state.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the c of the part icI of a skew-Hermitian W, n x n: Im tr W / n, rounded once.  0 where
/// |c| <= n ε ‖W‖_F: by so much steps move the trace by rounding, and no method sees it.  0, too,
/// if W is not finite.
double trace_part(const ConstMatrixView& W);

}  // namespace isosyrk
