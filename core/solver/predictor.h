// Predictor: start values of an iteration from past steps.
#pragma once

#include <array>
#include <vector>

#include "isosyrk/solver/linear_prediction.h"
#include "isosyrk/solver/unknowns.h"

namespace isosyrk {

/// Predicts each unknown from its own values in the last K steps, all of the same size:
///
///     x_{m+1} ≈ Σ_{k=1..K} w_k x_{m+1-k}
///
/// At first the weights are those of the polynomial through K values, w_k = (-1)^{k+1} C(K, k).
/// Once two weights can be fitted, the polynomial goes through the last p = 6 values only.  Its
/// error, the difference ∇^p x_{m+1}, is predicted by LinearPrediction from the differences before.
///
/// For an oscillation of frequency ω a polynomial through K values has the error (2 sin(ωh/2))^K.
/// Fitted weights reduce the error by about 2^(p-K), and by more for few frequencies.  Past solver
/// errors enter the fit, so the weights balance extrapolation error against noise amplification.
///
/// All unknowns share the same weights, fitted to some rows of each.  An unknown is not predicted
/// from the other stages: the nodes of the tableau are not equally spaced, and mixing stages
/// extrapolates badly.
class Predictor {
 public:
  static constexpr int most = LinearPrediction::most;

  /// For unknowns of these shapes, with at most `past_steps` past steps.  With 0 it never predicts.
  /// Throws std::invalid_argument unless 0 <= past_steps <= most.
  Predictor(int past_steps, const Unknowns& like);

  /// Sets x to the start values of a step of size h.  Returns false, with x unchanged, if there are
  /// no past steps of size h; the step must then start cold.
  bool predict(double h, Unknowns& x);

  /// Stores the unknowns that solved a step of size h.  Forgets past steps of another size.
  void accept(double h, const Unknowns& x);

  /// Forgets all past steps.
  void forget();
  /// The past steps that are stored, and the sequence of their differences.
  void archive(StateArchive& state);

 private:
  std::size_t place(int steps) const {
    return (newest_ + past_.size() - static_cast<std::size_t>(steps)) % past_.size();
  }
  const Unknowns& past(int steps) const { return past_[place(steps)]; }
  int weigh();
  void learn();

  std::vector<Unknowns> past_;  // a ring
  std::size_t newest_ = 0;
  int known_ = 0;  // number of past steps stored
  double h_ = 0.0;
  std::array<double, most> weights_{};  // the newest first
  LinearPrediction of_differences_;     // the sequence ∇^p of the sampled rows
};

}  // namespace isosyrk
