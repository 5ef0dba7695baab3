// What a step of an exponential method leaves to the next one.
#pragma once

#include <array>

#include "isosyrk/fast/start_error.h"
#include "isosyrk/fast/step_memory.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// ‖h² ∇F₂(μ)‖_F and ‖h⁴ ∇F₄(μ)‖_F as parts of ‖B(μ)‖_F, as last seen.  Of order 6 the first is the
/// norm of their sum but in the first evaluation of a run.
struct TermShares {
  std::array<double, 2> values = {1.0, 1.0};
  bool are_known = false;
};

/// What the parts of an exponential system leave to the next step.  All of it is a guess there: a
/// wrong one costs work, not digits.
struct ExponentialMemory final : StepMemory {
  /// For n x n matrices.
  explicit ExponentialMemory(Index n) : start_error(n), adjoint(n) {}

  void forget() override {
    shares = {};
    start_error.forget();
  }

  TermShares shares;
  StartError start_error;
  SplitMatrix adjoint;  ///< U† of the step, by which start_error is transported
};

}  // namespace isosyrk
