// Measured limits of the step size.
#pragma once

#include <optional>
#include <string_view>

namespace isosyrk {

/// Returns the largest h‖B(W₀)‖₂ below which an integrator worked in every recorded trial of the
/// smooth and the rough scene, or nothing if it was not tried.
/// Source: results/recorded/stability/map.json.
std::optional<double> measured_limit(std::string_view integrator);

}  // namespace isosyrk
