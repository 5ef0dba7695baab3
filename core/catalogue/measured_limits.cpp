#include "isosyrk/catalogue/measured_limits.h"

#include <algorithm>

namespace isosyrk {
namespace {

struct Limit {
  std::string_view integrator;
  Solver solver;
  Index n;
  double h_norm_B;
};

// Sorted by n within a form.
// clang-format off
// Written by scripts/update_limits: begin
constexpr Limit limits[] = {
    {"rk4", Solver::published, 17, 0.63},
};
// Written by scripts/update_limits: end
// clang-format on

}  // namespace

std::optional<double> measured_limit(std::string_view integrator, Solver solver, Index n) {
  std::optional<double> below;
  for (const Limit& limit : limits) {
    if (limit.integrator != integrator || limit.solver != solver) continue;
    if (limit.n == n) return limit.h_norm_B;
    if (limit.n > n) {
      if (!below) return {};
      return std::min(*below, limit.h_norm_B);
    }
    below = limit.h_norm_B;
  }
  return {};
}

}  // namespace isosyrk
