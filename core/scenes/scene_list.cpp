#include "isosyrk/scenes/scene_list.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

namespace isosyrk {

namespace scenes {
Scene smooth(const SceneParameters& parameters);
Scene rough(const SceneParameters& parameters);
Scene euler_top(const SceneParameters& parameters);
Scene rigid_body(const SceneParameters& parameters);
Scene spin_chain(const SceneParameters& parameters);
Scene symplectic(const SceneParameters& parameters);
Scene pseudo_unitary(const SceneParameters& parameters);
}  // namespace scenes

namespace {

struct Entry {
  const char* name;
  Scene (*make)(const SceneParameters& parameters);
};

constexpr Entry entries[] = {
    {"smooth", &scenes::smooth},
    {"rough", &scenes::rough},
    {"euler_top", &scenes::euler_top},
    {"rigid_body", &scenes::rigid_body},
    {"spin_chain", &scenes::spin_chain},
    {"symplectic", &scenes::symplectic},
    {"pseudo_unitary", &scenes::pseudo_unitary},
};

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
                                   [&](const Entry& each) { return wanted == each.name; });
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
