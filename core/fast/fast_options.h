// Options of the fast forms.
#pragma once

#include <optional>

#include "isosyrk/iteration/iteration_options.h"

namespace isosyrk {

/// Options of a fast integrator.
struct FastOptions {
  IterationOptions iteration = {};
  /// Threads that share the work, 1 to 64.  Fast forms use one below
  /// Tuning::smallest_parallel.  The answer is bit for bit the same for every number.
  int threads = 1;

  // Switches for ablation studies.
  /// Past steps of the predictor, 0 to Predictor::most; with 0 every step starts cold.  By default
  /// Tuning::past_steps.
  std::optional<int> past_steps = {};
  /// Inexact Newton; if false, Picard sweeps.
  bool newton = true;
  /// Band truncation.  By default on from n = Tuning::smallest_banded.
  std::optional<bool> bands = {};
};

}  // namespace isosyrk
