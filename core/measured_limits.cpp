#include "core/measured_limits.h"

#include <utility>

namespace isosyrk {
namespace {

// clang-format off
// Written by scripts/update_limits: begin
constexpr std::pair<std::string_view, double> limits[] = {
    {"group1", 1.35},
};
// Written by scripts/update_limits: end
// clang-format on

}  // namespace

std::optional<double> measured_limit(std::string_view integrator) {
  for (const auto& [name, limit] : limits) {
    if (name == integrator) return limit;
  }
  return {};
}

}  // namespace isosyrk
