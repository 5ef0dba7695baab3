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
    {"cotangent1", Solver::fast, 17, 2.59},
    {"cotangent1", Solver::published, 17, 1.24},
    {"cotangent1", Solver::published, 33, 1.29},
    {"cotangent2", Solver::fast, 17, 2.08},
    {"cotangent2", Solver::published, 17, 1.32},
    {"cotangent2", Solver::published, 33, 1.38},
    {"cotangent3", Solver::fast, 17, 1.95},
    {"cotangent3", Solver::published, 17, 1.35},
    {"cotangent3", Solver::published, 33, 1.38},
    {"group1", Solver::fast, 17, 2.53},
    {"group1", Solver::fast, 33, 2.53},
    {"group1", Solver::fast, 65, 2.89},
    {"group1", Solver::published, 17, 1.24},
    {"group1", Solver::published, 33, 1.29},
    {"group2", Solver::fast, 17, 2.22},
    {"group2", Solver::fast, 33, 2.27},
    {"group2", Solver::fast, 65, 2.59},
    {"group2", Solver::published, 17, 1.32},
    {"group2", Solver::published, 33, 1.38},
    {"group3", Solver::fast, 17, 2.18},
    {"group3", Solver::fast, 33, 2.27},
    {"group3", Solver::fast, 65, 2.43},
    {"group3", Solver::published, 17, 1.35},
    {"group3", Solver::published, 33, 1.38},
    {"algebra1", Solver::fast, 17, 1.68},
    {"algebra1", Solver::fast, 33, 1.87},
    {"algebra1", Solver::fast, 65, 1.87},
    {"algebra1", Solver::fast, 129, 2.18},
    {"algebra1", Solver::published, 17, 1.09},
    {"algebra1", Solver::published, 33, 1.06},
    {"algebra2", Solver::fast, 17, 3.36},
    {"algebra2", Solver::published, 17, 1.75},
    {"algebra2", Solver::published, 33, 1.91},
    {"algebra3", Solver::fast, 17, 3.08},
    {"algebra3", Solver::published, 17, 1.87},
    {"algebra3", Solver::published, 33, 2.00},
    {"group4", Solver::fast, 17, 2.43},
    {"group4", Solver::published, 17, 1.35},
    {"group5", Solver::fast, 17, 2.37},
    {"group5", Solver::published, 17, 1.35},
    {"group6", Solver::fast, 17, 2.37},
    {"group6", Solver::published, 17, 1.35},
    {"group7", Solver::fast, 17, 2.37},
    {"group7", Solver::published, 17, 1.35},
    {"group8", Solver::fast, 17, 2.32},
    {"group8", Solver::published, 17, 1.35},
    {"yoshida4", Solver::fast, 17, 1.09},
    {"yoshida4", Solver::published, 17, 0.64},
    {"suzuki4", Solver::fast, 17, 2.53},
    {"suzuki4", Solver::published, 17, 1.61},
    {"kahan_li6", Solver::fast, 17, 2.13},
    {"kahan_li6", Solver::published, 17, 1.35},
    {"rkmk4", Solver::fast, 17, 2.00},
    {"rkmk4", Solver::fast, 33, 4.17},
    {"rkmk4", Solver::fast, 65, 11.07},
    {"rkmk4", Solver::published, 17, 2.00},
    {"rkmk4", Solver::published, 33, 4.08},
    {"elp2", Solver::fast, 17, 5.30},
    {"elp2", Solver::published, 17, 4.55},
    {"elp4", Solver::fast, 17, 5.30},
    {"elp4", Solver::fast, 33, 5.07},
    {"elp4", Solver::fast, 65, 5.30},
    {"elp4", Solver::published, 17, 4.26},
    {"elp6", Solver::fast, 17, 4.45},
    {"elp6", Solver::fast, 33, 5.07},
    {"elp6", Solver::fast, 65, 5.30},
    {"elp6", Solver::published, 17, 4.17},
    {"magnus4", Solver::fast, 17, 1.06},
    {"magnus4", Solver::published, 17, 1.06},
    {"magnus5", Solver::fast, 17, 1.54},
    {"magnus5", Solver::fast, 33, 2.32},
    {"magnus5", Solver::fast, 65, 3.58},
    {"magnus5", Solver::published, 17, 1.54},
    {"magnus5", Solver::published, 33, 2.32},
    {"rk4_projected", Solver::fast, 17, 0.54},
    {"rk4_projected", Solver::fast, 33, 0.54},
    {"rk4_projected", Solver::fast, 65, 0.75},
    {"rk4_projected", Solver::published, 17, 0.54},
    {"rk4_projected", Solver::published, 33, 0.54},
    {"direct1", Solver::fast, 17, 0.85},
    {"direct1", Solver::published, 17, 0.89},
    {"direct2", Solver::fast, 17, 2.08},
    {"direct2", Solver::published, 17, 1.61},
    {"direct3", Solver::fast, 17, 2.48},
    {"direct3", Solver::published, 17, 2.08},
    {"rk4", Solver::fast, 17, 0.63},
    {"rk4", Solver::fast, 33, 0.73},
    {"rk4", Solver::fast, 65, 0.93},
    {"rk4", Solver::published, 17, 0.63},
    {"rk4", Solver::published, 33, 0.73},
    {"cotangent1_frame", Solver::fast, 17, 3.66},
    {"cotangent2_frame", Solver::fast, 17, 3.29},
    {"cotangent3_frame", Solver::fast, 17, 3.08},
    {"group1_frame", Solver::fast, 17, 3.83},
    {"group2_frame", Solver::fast, 17, 3.51},
    {"group2_frame", Solver::fast, 33, 3.15},
    {"group2_frame", Solver::fast, 65, 3.15},
    {"group2_frame", Solver::fast, 129, 5.18},
    {"group3_frame", Solver::fast, 17, 3.43},
    {"group3_frame", Solver::fast, 33, 2.95},
    {"group3_frame", Solver::fast, 65, 4.36},
    {"algebra1_frame", Solver::fast, 17, 2.37},
    {"algebra2_frame", Solver::fast, 17, 4.65},
    {"algebra3_frame", Solver::fast, 17, 4.45},
    {"group4_frame", Solver::fast, 17, 3.74},
    {"group5_frame", Solver::fast, 17, 3.74},
    {"group6_frame", Solver::fast, 17, 3.74},
    {"group7_frame", Solver::fast, 17, 3.74},
    {"group8_frame", Solver::fast, 17, 3.74},
    {"yoshida4_frame", Solver::fast, 17, 1.71},
    {"suzuki4_frame", Solver::fast, 17, 3.66},
    {"kahan_li6_frame", Solver::fast, 17, 3.08},
    {"rkmk4_frame", Solver::fast, 17, 2.22},
    {"elp2_frame", Solver::fast, 17, 8.17},
    {"elp4_frame", Solver::fast, 17, 6.58},
    {"elp4_frame", Solver::fast, 33, 7.17},
    {"elp4_frame", Solver::fast, 65, 6.72},
    {"elp4_frame", Solver::fast, 129, 9.11},
    {"elp6_frame", Solver::fast, 17, 5.65},
    {"elp6_frame", Solver::fast, 33, 6.72},
    {"elp6_frame", Solver::fast, 65, 6.72},
    {"elp6_frame", Solver::fast, 129, 9.11},
    {"magnus4_frame", Solver::fast, 17, 1.41},
    {"magnus5_frame", Solver::fast, 17, 2.08},
    {"magnus5_frame", Solver::fast, 33, 3.08},
    {"magnus5_frame", Solver::fast, 65, 4.86},
    {"magnus5_frame", Solver::fast, 129, 7.49},
    {"rk4_projected_frame", Solver::fast, 17, 0.87},
    {"rk4_frame", Solver::fast, 17, 1.00},
    {"rk4_frame", Solver::fast, 33, 0.89},
    {"rk4_frame", Solver::fast, 65, 1.24},
    {"rk4_frame", Solver::fast, 129, 2.53},
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
