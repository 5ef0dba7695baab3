// The memory of fast forms.
#pragma once

#include "isosyrk/integrators/formulation.h"

namespace isosyrk {

/// An upper bound of the memory in bytes of the Gauss method with s stages in the fast form of a
/// formulation, for n x n matrices, start values predicted from `past_steps` earlier steps and so
/// many threads.  At most half too large for n >= 33 and default options.
double fast_workspace_bytes(Formulation formulation, int s, Index n, int past_steps,
                            int threads = 1);

}  // namespace isosyrk
