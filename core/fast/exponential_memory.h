// What a step of an exponential method leaves to the next one.
#pragma once

#include "isosyrk/fast/start_error.h"
#include "isosyrk/fast/step_memory.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// What the parts of an exponential system leave to the next step.  All of it is a guess there: a
/// wrong one costs work, not digits.
struct ExponentialMemory final : StepMemory {
  /// For n x n matrices.
  explicit ExponentialMemory(Index n) : start_error(n), adjoint(n) {}

  void forget() override { start_error.forget(); }
  void archive(StateArchive& state) override { state.pass(start_error, adjoint); }

  StartError start_error;
  SplitMatrix adjoint;  ///< U† of the step, by which start_error is transported
};

}  // namespace isosyrk
