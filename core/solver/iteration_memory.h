// What an iteration leaves to that of the next step.
#pragma once

#include <optional>

#include "isosyrk/linalg/state_archive.h"
#include "isosyrk/solver/tuning.h"

namespace isosyrk {

/// What the iterations of earlier steps have shown.
struct IterationMemory {
  /// Last observed contraction of a Picard sweep near the solution.
  double contraction = tuning.likely_contraction;
  /// Change of the first sweep of the last iteration, relative to the unit; 0 if unknown.
  double start_change = 0.0;
  /// Change after a correction, as a part of the change before; the last seen.
  std::optional<double> left_by_correction = {};

  void forget() { *this = {}; }
  void archive(StateArchive& state) { state.pass(contraction, start_change, left_by_correction); }
};

}  // namespace isosyrk
