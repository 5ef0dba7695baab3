// The scale of a state: the unit in which an integrator holds W.
#pragma once

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// A power of two near ‖W‖₂, and the norm of the W for which it was found.  Integrators hold
/// V = W / value, so that every bound of an iteration, its tolerance for one, is relative to W in
/// the unknowns that scale with W.  Dividing by a power of two changes no digit.
struct StateScale {
  double value = 1.0;
  double frobenius_norm = 0.0;  ///< ‖W‖_F

  void archive(StateArchive& state) { state.pass(value, frobenius_norm); }
};

/// Returns ‖W‖_F, whose squares neither overflow nor underflow where they count.
double frobenius_norm(const ConstMatrixView& W);

/// Finds scales of n x n matrices.  Only the constructor allocates.
class ScaleFinder {
 public:
  explicit ScaleFinder(Index n);

  /// Returns the power of two nearest to ‖W‖₂, by ratio: 1 from √½ to √2.  ‖W‖₂ is estimated from
  /// below by power iteration, mostly to some percent.  1 if W is 0 or not finite.
  StateScale find(const ConstMatrixView& W);
  /// Returns whether ‖W‖_F is less than half or more than twice that of the given scale.
  static bool changed_twofold(const StateScale& scale, const ConstMatrixView& W);

 private:
  Eigen::VectorXcd start_, x_, y_;
};

}  // namespace isosyrk
