// Memory of the fast forms.
#pragma once

#include "isosyrk/fast/fast_matrices.h"
#include "isosyrk/integrators/formulation.h"

namespace isosyrk {

/// Returns what the Gauss method with s stages holds in the fast form of a formulation.
FastMatrices fast_gauss_matrices(Formulation formulation, int s);

/// Returns an upper bound of the memory of a fast form, in bytes; `past_steps` is the number of
/// past steps of the predictor.  For n >= 33 and default options the bound is at most 1.5 times the
/// memory (tests/allocation_test.cpp).
double fast_workspace_bytes(const FastMatrices& matrices, Index n, int past_steps, int threads);

}  // namespace isosyrk
