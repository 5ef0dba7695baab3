// Scenes of the Euler-Zeitlin equations: smooth, rough, and from initial data of one's own.
#pragma once

#include <string_view>
#include <vector>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/scenes/modes.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk {

/// Returns the Euler-Zeitlin scene with the given initial modes, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_valid(modes, n).
Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes);
/// Returns the Euler-Zeitlin scene with the initial data W₀ as they are, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_initial_data.
Scene euler_zeitlin_scene(std::string_view name, HbarConvention convention, const Matrix& W0);

/// Returns the scene of the paper's Table 1: Euler-Zeitlin from a few smooth modes, T = 5.  Throws
/// std::invalid_argument for n < 2 and as require_valid(modes, n); the default modes need n >= 5.
Scene smooth_scene(Index n, HbarConvention convention = HbarConvention::paper,
                   const std::vector<Mode>& modes = default_modes());

/// Returns Euler-Zeitlin from rough_modes(n), T = 5.  Throws std::invalid_argument for n < 2.
Scene rough_scene(Index n, HbarConvention convention = HbarConvention::paper);

/// Returns the initial modes of the scene "smooth" or "rough".  Throws std::invalid_argument for
/// another name, and as rough_modes(n).
std::vector<Mode> initial_modes(std::string_view scene, Index n);

}  // namespace isosyrk
