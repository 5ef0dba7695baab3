#include "isosyrk/catalogue/measured_limits.h"

#include <utility>

namespace isosyrk {
namespace {

// clang-format off
// Written by scripts/update_limits: begin
constexpr std::pair<std::string_view, double> limits[] = {
    {"cotangent1", 1.35},
    {"cotangent2", 1.44},
    {"cotangent3", 1.44},
    {"group1", 1.35},
    {"group2", 1.44},
    {"group3", 1.44},
    {"algebra1", 1.13},
    {"algebra2", 1.73},
    {"algebra3", 1.79},
    {"group4", 1.44},
    {"group5", 1.44},
    {"yoshida4", 0.66},
    {"suzuki4", 1.71},
    {"kahan_li6", 1.41},
    {"rkmk4", 4.91},
    {"direct1", 0.92},
    {"direct2", 1.66},
    {"direct3", 2.20},
    {"rk4", 0.63},
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
