// The list of scenes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "isosyrk/scenes/scene.h"

namespace isosyrk {

/// Returns the names of all scenes; those of Euler-Zeitlin come first.
const std::vector<std::string>& scene_names();
/// Tells whether this is a scene of Euler-Zeitlin: "smooth" or "rough".
bool is_euler_zeitlin(std::string_view scene);
/// Returns the scene with this name.  Throws std::invalid_argument, naming all scenes, for another
/// name, and for parameters that the scene does not have or that are out of its range.
Scene scene_by_name(std::string_view name, const SceneParameters& parameters);
/// Returns a scene that has no parameters but n.
inline Scene scene_by_name(std::string_view name, Index n) {
  return scene_by_name(name, SceneParameters{.n = n});
}

}  // namespace isosyrk
