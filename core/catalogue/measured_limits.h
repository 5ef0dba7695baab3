// Measured limits of the step size.
#pragma once

#include <optional>
#include <string_view>

#include "isosyrk/catalogue/solver.h"
#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the largest h‖B(W₀)‖₂ at which a form of an integrator worked in every recorded run of
/// Euler–Zeitlin: to T = 50 from smooth_scene(n), rough_scene(n) and a developed state of the
/// latter (n = 129: smooth), to T = 5 from four others of each kind. Between two recorded n, the
/// smaller limit; n is recorded up to 33 for published forms, to 65 or 129 for fast ones.  Empty
/// beyond the recorded n, and for forms that were not tried or never passed.  B is that of the flow
/// without co-rotating frame, also for integrators in the frame.
///
/// Source: results/recorded/limits/raw.json.
std::optional<double> measured_limit(std::string_view integrator, Solver solver, Index n);

}  // namespace isosyrk
