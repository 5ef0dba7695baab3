// Anderson acceleration of a fixed-point iteration.
#pragma once

#include <array>
#include <vector>

#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Takes the place of x_{k+1} = g_k in an iteration x = G(x) (D. G. Anderson, J. ACM 12, 1965, of
/// depth 2):
///
///     x_{k+1} = g_k - Σ_j γ_j (g_{j+1} - g_j),   γ minimising |f_k - Σ_j γ_j (f_{j+1} - f_j)|
///
/// over the last two pairs of sweeps, with g_k = G(x_k) and f_k = g_k - x_k.  It forms no product,
/// but reads and writes as much as a dozen sums of matrices; what is remembered are differences, in
/// single precision, of which only the direction of a correction is made.  The weights are real, so
/// that what is skew-Hermitian stays so exactly.
class Anderson {
 public:
  explicit Anderson(const Unknowns& unknowns);

  /// The iteration begins at x.
  void begin(const Unknowns& x);

  /// x holds g_k; replaces it by x_{k+1}.
  void mix(Unknowns& x);

 private:
  static constexpr int depth = 2;
  using Singles = Eigen::VectorXf;

  struct Unknown {
    RealVector x;
    Singles f, step;  // the last f_k, and x_{k+1} - x_k
    std::array<Singles, depth> df, dg;
  };

  void remember(const SplitMatrix& g, Unknown& unknown, std::size_t slot, bool has_pair);

  std::vector<Unknown> unknowns_;
  int sweeps_ = 0;
  double dots_[depth][depth] = {};  // of the differences of f
  double right_[depth] = {};        // of each with f_k
};

}  // namespace isosyrk
