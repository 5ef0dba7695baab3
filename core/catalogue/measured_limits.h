// Measured limits of the step size.
#pragma once

#include <optional>
#include <string_view>

#include "isosyrk/catalogue/solver.h"
#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the largest h‖B(W₀)‖₂ at which a form of an integrator worked in every recorded run of
/// Euler–Zeitlin: to T = 50 from the smooth, rough and developed scene (n = 129: smooth), to T = 5
/// from four other states of each kind.  Taken is the lesser value of the recorded n on both sides
/// of n; n is recorded up to 33 for published forms, to 65 or 129 for fast ones.  Nothing beyond
/// them, and for a form that was not tried or has no safe step.  B is that of the flow without
/// co-rotating frame, also for integrators in the frame.
/// Source: results/recorded/limits/raw.json.
std::optional<double> measured_limit(std::string_view integrator, Solver solver, Index n);

}  // namespace isosyrk
