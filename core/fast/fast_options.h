// Options of the fast forms.
#pragma once

#include <optional>

#include "isosyrk/iteration/iteration_options.h"

namespace isosyrk {

/// Options of a fast integrator.
struct FastOptions {
  IterationOptions iteration = {};
  /// Threads that share the work, 1 to 64.  Fewer are used where n is small (Tuning::threads).  The
  /// answer is bit for bit the same for every number.
  int threads = 1;

  // Switches for ablation studies.  Forms that do not have a part ignore its switch; none moves the
  // answer by more than the tolerance.
  /// Past steps of the predictor, 0 to Predictor::most; with 0 every step starts cold, or
  /// from an explicit step.  By default Tuning::past_steps.
  std::optional<int> past_steps = {};
  /// Inexact Newton; if false, Picard sweeps.
  bool newton = true;
  /// Band truncation.  By default on from n = Tuning::smallest_banded.
  std::optional<bool> bands = {};
  // Of exponential Lie-Poisson forms alone:
  /// Start values from a step of an explicit method.  If there are no past steps either, each step
  /// starts cold.
  bool explicit_start = true;
  /// Acceptance by the estimated error of a correction; if false, by the change of one more sweep.
  bool error_estimates = true;
  // And of these and the Munthe-Kaas form:
  /// Series of commutators that end where the wanted accuracy is reached; if false, each goes on to
  /// rounding.
  bool graded_series = true;
};

}  // namespace isosyrk
