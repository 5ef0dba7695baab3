// The step to which the parts of an exponential system are bound.
#pragma once

#include "isosyrk/fast/exponential_memory.h"
#include "isosyrk/fast/split_operations.h"
#include "isosyrk/integrators/unit_of_exponent.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

/// A step W₀ -> W₁ of size h, and the memory of the steps before it.
struct ExponentialStep {
  /// For n x n matrices.
  explicit ExponentialStep(Index n) : W0_single(n) {}

  /// Begins a step, to be solved to the tolerance.  W₀ and the memory must stay until its end.
  void bind(const SplitMatrix& state, double step, double to_tolerance, ExponentialMemory& of_steps,
            SplitOperations& operations);
  /// Returns the size of Ω to which the tolerance and all accuracies are relative.
  double unit(const SplitMatrix& Omega) const { return unit_of_exponent(norm(Omega), least_unit); }

  const SplitMatrix* W0 = nullptr;
  SingleMatrix W0_single;  // W₀, cut to its band
  double h = 0.0;
  double tolerance = 0.0;
  double size_of_W0 = 0.0;  // ‖W₀‖_F
  double rotation = 0.0;    // ‖hR‖_F of the rotation R that B is left without
  double least_unit = 0.0;  // least_unit_of_exponent()
  ExponentialMemory* memory = nullptr;
};

}  // namespace isosyrk
