// Start values of an iteration from the steps before.
#pragma once

#include <array>
#include <vector>

#include "isosyrk/solver/linear_prediction.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Predicts each unknown from its own values in the last K steps of one size:
///
///     x_{m+1} ≈ Σ_{k=1..K} w_k x_{m+1-k}
///
/// While K < p + 2, p = Tuning::differences, by the polynomial through them, w_k = (-1)^{k+1} C(K, k).
/// After that the polynomial through the last p values is used, and what it leaves, the difference
/// ∇^p x_{m+1}, is predicted from the K - p differences before (LinearPrediction).  In an oscillation
/// of frequency ω a polynomial through K values errs by (2 sin(ωh/2))^K, the fitted weights by some
/// 2^(p-K) of that, and by less where there are few frequencies.  Past solver errors enter the fit, so
/// the weights balance extrapolation error against noise amplification.
///
/// All unknowns have the same weights, fitted to some rows of each.  Each unknown is smooth from step
/// to step; those of one step, at the nodes of the tableau, are not spaced equally, and mixing them
/// extrapolates badly.  A composition takes a predictor for each substep.
class Predictor {
 public:
  static constexpr int most = LinearPrediction::most;

  /// For unknowns of these shapes, from at most so many past steps; with 0 it never predicts.  Throws
  /// std::invalid_argument unless 0 <= past_steps <= most.
  Predictor(int past_steps, const Unknowns& like);

  /// Sets x for a step of size h.  False, with x as it was, if the step must start cold: as the first,
  /// and the first of another size or after forget().
  bool predict(double h, Unknowns& x);

  /// Takes the unknowns that solved a step of size h.
  void accept(double h, const Unknowns& x);

  void forget();

 private:
  const Unknowns& past(int steps) const {
    return past_[(newest_ + past_.size() - static_cast<std::size_t>(steps)) % past_.size()];
  }
  int weigh();
  void learn();

  std::vector<Unknowns> past_;  // a ring
  std::size_t newest_ = 0;
  int known_ = 0;  // past steps
  double h_ = 0.0;
  std::array<double, most> weights_{};  // the newest first
  LinearPrediction of_differences_;     // of the sampled rows
};

}  // namespace isosyrk
