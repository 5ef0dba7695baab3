// Options of the fast forms.
#pragma once

#include <optional>

#include "isosyrk/iteration/status.h"

namespace isosyrk {

struct FastOptions {
  SolverOptions solver;
  /// Threads that share the work, 1 to 64; one is taken where more would not pay.  The answer is the
  /// same bit for bit.
  int threads = 1;

  // Switches by which a study measures each idea.
  /// Past steps that the predictor reads, at most 24; 0: every step starts cold.  By default
  /// Tuning::past_steps.
  std::optional<int> past_steps = {};
  /// Newton corrections in single precision; without them, Picard sweeps.
  bool newton = true;
  /// Band truncation; by default from Tuning::smallest_banded on.
  std::optional<bool> bands = {};
};

}  // namespace isosyrk
