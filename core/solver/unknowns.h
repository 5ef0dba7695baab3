// Unknowns of a step and corrections to them, as solvers and predictors see them.
#pragma once

#include <vector>

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// The unknowns of a step, as a list of kinds, such as Q and P.  Each kind is a list of matrices.
using Unknowns = std::vector<SplitStages>;
/// Corrections to unknowns, in single precision.
using Corrections = std::vector<SingleStages>;

/// Returns zero corrections to unknowns of these shapes.
inline Corrections corrections_like(const Unknowns& x) {
  Corrections zero;
  for (const SplitStages& kind : x) {
    zero.push_back(
        split_stages<float>(static_cast<Index>(kind.size()), kind.empty() ? 0 : kind[0].size()));
  }
  return zero;
}

/// out = delta, of the same shapes.
inline void copy(Corrections& out, const Corrections& delta) {
  for (std::size_t kind = 0; kind < out.size(); ++kind) copy(out[kind], delta[kind]);
}

/// x += delta.
inline void add(Unknowns& x, const Corrections& delta) {
  for (std::size_t kind = 0; kind < x.size(); ++kind) add(x[kind], delta[kind]);
}

/// Returns the largest Frobenius norm of a difference x - y, NaN if any is NaN.
inline double largest_difference(const Unknowns& x, const Unknowns& y) {
  double largest = 0.0;
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    for (std::size_t i = 0; i < x[kind].size(); ++i) {
      largest = larger(largest, (x[kind][i].entries() - y[kind][i].entries()).norm());
    }
  }
  return largest;
}

}  // namespace isosyrk
