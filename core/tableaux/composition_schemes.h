// Composition schemes as pure data.
#pragma once

#include <string>
#include <vector>

namespace isosyrk {

/// Fractions γ_1 .. γ_k of a step: step(h) = midpoint(γ_k h) ∘ ... ∘ midpoint(γ_1 h).
struct CompositionScheme {
  std::string name;
  int order;
  std::vector<double> fractions;  ///< symmetric, summing to 1
};

/// Three stages, order 4.  Source: Yoshida 1990; Hairer, Lubich, Wanner, (II.4.4).
CompositionScheme yoshida4();
/// Five stages, order 4, with a smaller error constant than yoshida4.  Source: Suzuki 1990; Hairer,
/// Lubich, Wanner, (II.4.5).
CompositionScheme suzuki4();
/// Nine stages, order 6.  Source: Kahan and Li 1997; Hairer, Lubich, Wanner, (V.3.11).
CompositionScheme kahan_li6();

}  // namespace isosyrk
