// Anderson acceleration of a fixed-point iteration.
#pragma once

#include <array>
#include <vector>

#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Replaces x_{k+1} = g_k in a Picard iteration x = G(x) by Anderson's mixing of depth 2:
///
///     x_{k+1} = g_k - Σ_j γ_j (g_{j+1} - g_j),   γ minimising |f_k - Σ_j γ_j (f_{j+1} - f_j)|
///
/// over the last two pairs of sweeps, with g_k = G(x_k) and f_k = g_k - x_k.  No products are
/// formed; the memory traffic is that of about a dozen linear combinations.  The differences are
/// stored in single precision, since they give only the direction of a correction.  The weights are
/// real, so skew-Hermitian unknowns stay so exactly.  Only the constructor allocates.
/// Source: D. G. Anderson, J. ACM 12, 1965.
class Anderson {
 public:
  /// For unknowns of these shapes.
  explicit Anderson(const Unknowns& unknowns);

  /// Starts an iteration at x.
  void begin(const Unknowns& x);

  /// Replaces x = g_k by x_{k+1}.
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
  double dots_[depth][depth] = {};  // dot products of the differences of f
  double right_[depth] = {};        // dot products of each difference with f_k
};

}  // namespace isosyrk
