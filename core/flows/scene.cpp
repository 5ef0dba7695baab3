#include "isosyrk/flows/scene.h"

#include <fmt/ranges.h>

#include <stdexcept>

namespace isosyrk {

Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes) {
  return {std::string(name), std::make_shared<EulerZeitlin>(n, convention),
          vorticity_from_modes(modes, n), 5.0};
}

Scene smooth_scene(Index n, HbarConvention convention, const std::vector<Mode>& modes) {
  return euler_zeitlin_scene("smooth", n, convention, modes);
}

Scene rough_scene(Index n, HbarConvention convention) {
  return euler_zeitlin_scene("rough", n, convention, rough_modes(n));
}

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = {"smooth", "rough"};
  return names;
}

std::vector<Mode> initial_modes(std::string_view scene, Index n) {
  if (scene == "smooth") return default_modes();
  if (scene == "rough") return rough_modes(n);
  throw std::invalid_argument(
      fmt::format("scene '{}': must be one of {}", scene, fmt::join(scene_names(), ", ")));
}

Scene scene_by_name(std::string_view name, Index n, HbarConvention convention) {
  return euler_zeitlin_scene(name, n, convention, initial_modes(name, n));
}

}  // namespace isosyrk
