// Measured limits of the step size.
#pragma once

#include <optional>
#include <string_view>

#include "isosyrk/catalogue/solver.h"
#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the largest h‖B(W₀)‖₂ at which a form of an integrator worked in every recorded run of
/// Euler–Zeitlin to T = 50 (smooth, rough and developed scene), at the recorded n on both sides of
/// n, or at the nearest one.  Nothing if that form was not tried.  B is that of the flow without
/// co-rotating frame, also for integrators in the frame.
/// Source: results/recorded/limits/raw.json.
std::optional<double> measured_limit(std::string_view integrator, Solver solver, Index n);

}  // namespace isosyrk
