// Memory of the fast forms.
#pragma once

#include "isosyrk/integrators/formulation.h"

namespace isosyrk {

/// Returns an upper bound of the memory, in bytes, of the Gauss method with s stages in the fast
/// form of a formulation.  n x n matrices; `past_steps` is the number of past steps of the
/// predictor.  For n >= 33 and default options the bound is at most 1.5 times the memory
/// (tests/allocation_test.cpp).
double fast_workspace_bytes(Formulation formulation, int s, Index n, int past_steps,
                            int threads = 1);

}  // namespace isosyrk
