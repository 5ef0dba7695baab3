// Quadrature of the integral in the coupling K of exponential methods.
#pragma once

#include <array>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// A node of Gauss quadrature of ∫₀¹ f(s) s ds ≈ Σ weight f(s).
struct CouplingNode {
  double s;
  double weight;
};

inline constexpr double root_of_6 = 2.449489742783178;
/// The rule of one node, and after it the rule of two: Σ w = 1/2, Σ w s = 1/3 in each.
inline constexpr std::array<CouplingNode, 3> coupling_nodes = {
    {{2.0 / 3.0, 0.5},
     {(6.0 - root_of_6) / 10.0, 0.25 - 1.0 / (6.0 * root_of_6)},
     {(6.0 + root_of_6) / 10.0, 0.25 + 1.0 / (6.0 * root_of_6)}}};

/// The states e^{s ad_Ω} W₀ at the nodes, in single precision.
struct StatesAtNodes {
  static constexpr std::size_t most = coupling_nodes.size();

  /// For n x n matrices.
  explicit StatesAtNodes(Index n) { W.fill(SingleMatrix(n)); }

  std::array<SingleMatrix, most> W;
};

}  // namespace isosyrk
