// Start values of an iteration from the steps before.
#pragma once

#include <array>
#include <vector>

#include "core/planar_matrix.h"
#include "core/share.h"

namespace isosyrk {

/// The unknowns of a step: a few kinds, such as Q and P, each with so many of its own.
using Unknowns = std::vector<std::vector<PlanarMatrix>>;

/// Extrapolates each unknown from its own values in the last steps of one size, at equal distances:
/// by the polynomial through the last p of them (as many as there are, if
/// fewer),
///
///     x_{m+1} ≈ Σ_{k=1..p} (-1)^{k+1} C(p, k) x_{m+1-k}
///
/// Each unknown is smooth from step to step; those of one step, at the nodes of the tableau, are
/// not spaced equally, and mixing them extrapolates badly.  The weights add up to 2^p - 1 in
/// modulus, by which the noise of earlier iterations is amplified.
class StartValues {
 public:
  /// For unknowns like these; p = 0 starts cold always.  Throws std::invalid_argument unless
  /// 0 <= p <= 12.
  StartValues(int p, const Unknowns& unknowns);

  /// Whether a step of size h can be predicted: else it must start cold, as the first, and the
  /// first of another size or after forget().
  bool begin(double h);
  /// Sets an unknown for it, or a share of it.
  void predict(std::size_t kind, std::size_t unknown, PlanarMatrix& X, Share share) const;

  /// That a step of size h was solved, by unknowns which then are kept, shares of each.
  void accept(double h);
  void keep(std::size_t kind, std::size_t unknown, const PlanarMatrix& X, Share share);

  void forget() { known_ = 0; }

 private:
  static constexpr int largest = 12;

  int p_;
  int known_ = 0;  // past steps
  std::size_t newest_ = 0;
  double h_ = 0.0;
  std::array<double, largest> weights_{};  // of what is known, the newest first
  std::vector<Unknowns> past_;             // a ring of p
};

}  // namespace isosyrk
