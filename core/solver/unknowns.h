// What solvers and predictors know of a step: its unknowns.
#pragma once

#include <vector>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The unknowns of a step: a few kinds, such as Q and P, each with some matrices of its own.
using Unknowns = std::vector<SplitStages>;
/// Changes of them, in single precision.
using Corrections = std::vector<SingleStages>;

/// Zero corrections to unknowns of these shapes.
inline Corrections corrections_like(const Unknowns& x) {
  Corrections zero;
  for (const SplitStages& kind : x) {
    zero.push_back(split_stages<float>(static_cast<Index>(kind.size()),
                                       kind.empty() ? 0 : kind[0].size()));
  }
  return zero;
}

}  // namespace isosyrk
