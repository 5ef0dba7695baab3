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
/// The rule of two nodes: Σ w = 1/2, Σ w s = 1/3, Σ w s² = 1/4, Σ w s³ = 1/5.
inline constexpr std::array<CouplingNode, 2> coupling_nodes = {
    {{(6.0 - root_of_6) / 10.0, 0.25 - 1.0 / (6.0 * root_of_6)},
     {(6.0 + root_of_6) / 10.0, 0.25 + 1.0 / (6.0 * root_of_6)}}};

/// A matrix for each node, in single precision.
using AtNodes = std::array<SingleMatrix, coupling_nodes.size()>;

}  // namespace isosyrk
