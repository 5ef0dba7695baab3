// Options of an iteration.
#pragma once

namespace isosyrk {

/// Stopping rule of an iteration.  Changes of unknowns that scale with W (W̃, P, X, K) are in units
/// of a power of two near ‖W‖₂ (integrators/state_scale.h), and so relative; those of Q are
/// absolute, those of Ω of exponential methods relative to ‖Ω‖_F, or to more in the frame
/// (integrators/unit_of_exponent.h).
struct IterationOptions {
  double tolerance = 1e-13;  ///< on the largest change of an unknown, Frobenius norm
  int max_sweeps = 1000;
  /// Called after every sweep, if set.  It may throw: the step then ends and leaves W unchanged.
  void (*after_sweep)() = nullptr;

  void swept() const {
    if (after_sweep != nullptr) after_sweep();
  }
};

}  // namespace isosyrk
