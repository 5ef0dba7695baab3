// What a solver and a predictor know of a step: its unknowns.
#pragma once

#include <vector>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The unknowns of a step: a few kinds, such as Q and P, each with so many of its own.
using Unknowns = std::vector<std::vector<PlanarMatrix>>;

}  // namespace isosyrk
