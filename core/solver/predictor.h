// Start values of an iteration from the steps before.
#pragma once

#include <array>
#include <vector>

#include "isosyrk/solver/linear_prediction.h"
#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Predicts each unknown from its own values in the last steps of one size, at equal distances:
///
///     x_{m+1} ≈ Σ_{k=1..K} w_k x_{m+1-k}
///
/// As long as there are few, by the polynomial through them, w_k = (-1)^{k+1} C(K, k).  From
/// `differences` + 2 on what the polynomial through the last p = `differences` of them leaves, the
/// difference ∇^p x_{m+1}, is predicted in its turn (linear_prediction.h), from K - p such of steps
/// before.  In an oscillation of frequency ω a polynomial through as many errs by
/// (2 sin(ωh/2))^K, the fitted weights by some 2^(p-K) of that, and by less where there are few
/// frequencies.  The fit sees the noise of earlier iterations too, and so does not amplify it
/// further than pays.
///
/// All unknowns have the same weights, fitted to some rows of each.  Each unknown is smooth from
/// step to step; those of one step, at the nodes of the tableau, are not spaced equally, and mixing
/// them extrapolates badly.
class StartValues {
 public:
  static constexpr int most = LinearPrediction::most;
  static constexpr int differences = 6;

  /// From at most so many steps, for unknowns like these; 0 starts cold always.  Not `fitted`, by
  /// the polynomial through all of them.  Throws std::invalid_argument unless 0 <= steps <= most.
  StartValues(int steps, bool fitted, const Unknowns& unknowns);

  /// Whether a step of size h can be predicted: else it must start cold, as the first, and the
  /// first of another size or after forget().
  bool begin(double h);
  /// Sets an unknown for it, or a share of it.
  void predict(std::size_t kind, std::size_t unknown, PlanarMatrix& X, Share share) const;

  /// That a step of size h was solved, by unknowns which then are kept, shares of each, and after
  /// all of them learned from.
  void accept(double h);
  void keep(std::size_t kind, std::size_t unknown, const PlanarMatrix& X, Share share);
  void learn();

  void forget();

 private:
  const Unknowns& past(int steps) const {
    return past_[(newest_ + past_.size() - static_cast<std::size_t>(steps)) % past_.size()];
  }

  void difference(std::size_t kind, std::size_t unknown, Index begin, double* to) const;

  std::vector<Unknowns> past_;  // a ring
  std::size_t newest_ = 0;
  int known_ = 0;  // past steps
  double h_ = 0.0;
  int count_ = 0;                       // of weights
  std::array<double, most> weights_{};  // the newest first
  bool fitted_;
  LinearPrediction of_differences_;  // of what is sampled of the unknowns
};

}  // namespace isosyrk
