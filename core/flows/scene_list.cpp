// The list of scenes.
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "isosyrk/flows/scene.h"

namespace isosyrk {

// One line a scene: its name, which is also that of the function in isosyrk::scenes that makes it.
// Each function has the signature  Scene NAME(const SceneParameters&).
#define ISOSYRK_SCENES(SCENE) \
  SCENE(smooth)               \
  SCENE(rough)                \
  SCENE(euler_top)            \
  SCENE(rigid_body)           \
  SCENE(spin_chain)           \
  SCENE(symplectic)           \
  SCENE(pseudo_unitary)

namespace scenes {
#define ISOSYRK_DECLARE(name) Scene name(const SceneParameters& parameters);
ISOSYRK_SCENES(ISOSYRK_DECLARE)
}  // namespace scenes

namespace {

struct Entry {
  std::string name;
  Scene (*make)(const SceneParameters& parameters);
};

#define ISOSYRK_ENTRY(name) {#name, &scenes::name},
const Entry entries[] = {ISOSYRK_SCENES(ISOSYRK_ENTRY)};

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found;
    for (const Entry& entry : entries) found.push_back(entry.name);
    return found;
  }();
  return names;
}

bool is_euler_zeitlin(std::string_view scene) { return scene == "smooth" || scene == "rough"; }

Scene scene_by_name(std::string_view wanted, const SceneParameters& parameters) {
  const auto* entry = std::find_if(std::begin(entries), std::end(entries),
                                   [&](const Entry& each) { return each.name == wanted; });
  if (entry == std::end(entries)) {
    throw std::invalid_argument(
        fmt::format("scene '{}': must be one of {}", wanted, fmt::join(scene_names(), ", ")));
  }
  if (parameters.hbar && !is_euler_zeitlin(wanted)) {
    throw std::invalid_argument(
        fmt::format("hbar: goes with Euler-Zeitlin (smooth, rough), not with {}", wanted));
  }
  if (parameters.signature && wanted != "pseudo_unitary") {
    throw std::invalid_argument(
        fmt::format("signature: goes with pseudo_unitary, not with {}", wanted));
  }
  return entry->make(parameters);
}

}  // namespace isosyrk
