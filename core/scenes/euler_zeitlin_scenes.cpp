#include "isosyrk/scenes/euler_zeitlin_scenes.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

Scene euler_zeitlin_scene(std::string_view name, Index n, HbarConvention convention,
                          const std::vector<Mode>& modes) {
  return {std::string(name), std::make_shared<EulerZeitlin>(n, convention),
          vorticity_from_modes(modes, n), 5.0};
}

Scene euler_zeitlin_scene(std::string_view name, HbarConvention convention, const Matrix& W0) {
  const Index n = W0.rows();
  auto flow = std::make_shared<EulerZeitlin>(n, convention);
  require_initial_data(W0, n);
  return {std::string(name), std::move(flow), W0, 5.0};
}

Scene smooth_scene(Index n, HbarConvention convention, const std::vector<Mode>& modes) {
  return euler_zeitlin_scene("smooth", n, convention, modes);
}

Scene rough_scene(Index n, HbarConvention convention) {
  return euler_zeitlin_scene("rough", n, convention, rough_modes(n));
}

std::vector<Mode> initial_modes(std::string_view scene, Index n) {
  if (scene == "smooth") return default_modes();
  if (scene == "rough") return rough_modes(n);
  throw std::invalid_argument(fmt::format("scene '{}': has no modes", scene));
}

namespace scenes {

Scene smooth(const SceneParameters& parameters) {
  return smooth_scene(parameters.n, parameters.hbar.value_or(HbarConvention::paper));
}

Scene rough(const SceneParameters& parameters) {
  return rough_scene(parameters.n, parameters.hbar.value_or(HbarConvention::paper));
}

}  // namespace scenes
}  // namespace isosyrk
