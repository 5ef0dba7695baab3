// Quadrature of the integral in the coupling K of exponential methods.
#pragma once

#include <array>
#include <cmath>

namespace isosyrk {

/// A node of Gauss quadrature of ∫₀¹ f(s) s ds ≈ Σ weight f(s).
struct CouplingNode {
  double s;
  double weight;
};

/// The rule of one node, and after it the rule of two: Σ w = 1/2, Σ w s = 1/3 in each.
inline std::array<CouplingNode, 3> coupling_nodes() {
  const double root6 = std::sqrt(6.0);
  return {{{2.0 / 3.0, 0.5},
           {(6.0 - root6) / 10.0, 0.25 - 1.0 / (6.0 * root6)},
           {(6.0 + root6) / 10.0, 0.25 + 1.0 / (6.0 * root6)}}};
}

}  // namespace isosyrk
