// Measured limits of the step size.
#pragma once

#include <optional>
#include <string_view>

#include "isosyrk/catalogue/solver.h"
#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the largest h‖B(W₀)‖₂ at which a form of an integrator survived every recorded run of
/// Euler–Zeitlin.  It says nothing of accuracy: the solver did not fail, and neither a tenth of the
/// energy was lost nor the spectrum.  Runs from smooth_scene(n), rough_scene(n) and a developed
/// state (n = 129: smooth) lasted to T = 50 or longer, in 500 steps at least, of explicit methods
/// 4000.  Those from drawn states of each kind were a tenth as long.
///
/// Between two recorded n, the smaller limit.  Published forms are recorded for n = 17, group and
/// algebra forms for 33 too, fast forms to n = 17, 33, 65 or 129, implicit exponential ones from
/// n = 33 on.  Empty beyond the recorded n and where no step survived.  Empty also for published
/// forms in the co-rotating frame, which are not tried: the frame is there for speed, and so is the
/// fast form.  B is that of the flow without co-rotating frame, also for integrators in the frame.
///
/// Source: results/recorded/limits/raw.json.
std::optional<double> measured_limit(std::string_view integrator, Solver solver, Index n);

}  // namespace isosyrk
