// How long a step was seen to work.
#pragma once

#include <optional>
#include <string_view>

namespace isosyrk {

/// The largest h‖B(W₀)‖₂ below which an integrator worked in every recorded trial, smooth and rough
/// scene at every n; none where it was not tried.  Source: results/recorded/stability/map.json.
std::optional<double> measured_limit(std::string_view integrator);

}  // namespace isosyrk
