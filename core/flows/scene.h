// Scenes: a flow with initial data, a name and a time span.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/modes.h"

namespace isosyrk {

/// What is simulated, as data.
struct Scene {
  std::string name;
  std::shared_ptr<const Flow> flow;
  Matrix initial;  ///< W at time 0, n x n, spectral norm 1
  double time;     ///< end of the time span
};

/// Euler-Zeitlin from given modes, T = 5.  Throws std::invalid_argument for n < 2 or modes that do
/// not fit n.
Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes);

/// The scene of the paper's Table 1: Euler-Zeitlin from a few smooth modes (by default those with
/// l <= 4), T = 5.  Throws std::invalid_argument for n < 2 or modes that do not fit n.
Scene smooth_scene(Index n, HbarConvention convention = HbarConvention::paper,
                   const std::vector<Mode>& modes = default_modes());

/// Euler-Zeitlin from rough_modes(n), T = 5.  Throws std::invalid_argument for n < 2.
Scene rough_scene(Index n, HbarConvention convention = HbarConvention::paper);

/// "smooth", "rough".
const std::vector<std::string>& scene_names();
/// The initial modes of the scene of this name.  Throws std::invalid_argument, naming what is
/// allowed.
std::vector<Mode> initial_modes(std::string_view scene, Index n);
/// The scene of this name.  Throws std::invalid_argument, naming what is allowed, or as the scene.
Scene scene_by_name(std::string_view name, Index n,
                    HbarConvention convention = HbarConvention::paper);

}  // namespace isosyrk
