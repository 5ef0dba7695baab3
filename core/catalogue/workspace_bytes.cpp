#include "isosyrk/catalogue/workspace_bytes.h"

#include <algorithm>

#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

FastMatrices fast_gauss_matrices(Formulation formulation, int stages) {
  const double s = stages;
  const double pairs = 0.5 * s * (s - 1.0);
  switch (formulation) {
    case Formulation::cotangent:
      return {2.0 * s, 4.0 * s + 3.0, 8.0 * s};
    case Formulation::group:
      return {s, 4.0 * s + 3.0, 7.0 * s};
    case Formulation::algebra:
      break;
  }
  if (s == 1.0) return {1.0, 5.0, 9.0};  // the midpoint
  return {2.0 * s + pairs, 9.0 * s + 3.0 * pairs + 2.0, 10.0 * s + 4.0 * pairs};
}

double fast_workspace_bytes(const FastMatrices& matrices, Index n, int past_steps, int threads) {
  const auto [unknowns, doubles, singles] = matrices;
  const auto size = static_cast<double>(n);
  const double in_double = 16.0 * size * static_cast<double>(split_row<double>(n));
  const double in_single = 8.0 * size * static_cast<double>(split_row<float>(n));
  // In double: the unknowns, the predictor's and Anderson's copies.  In single: residual,
  // corrections and Anderson's differences.
  // The predictor keeps some rows of the differences of past steps besides.
  const double sampled = static_cast<double>(tuning.sampled_rows) / size *
                         std::max(0, past_steps - Tuning::differences + 1);
  const double solver = unknowns * ((2.0 + past_steps + sampled) * in_double + 10.0 * in_single);
  // W₀ and W₁, interleaved and split, and the factors of the Laplacian.  Each thread adds a packing
  // space.
  const double common = 32.0 * size * size + 3.0 * in_double + in_single;
  const double diagonals = 16.0 * size * (unknowns + 3.0);  // sums over them, for band truncation
  return solver + doubles * in_double + singles * in_single + common +
         threads * (in_double + in_single) + diagonals;
}

}  // namespace isosyrk
