// Symmetric compositions of the isospectral midpoint rule.  These are the isospectral symplectic
// DIRK methods of the paper's footnote.
#pragma once

#include <vector>

#include "isosyrk/integrators/isospectral_midpoint.h"
#include "isosyrk/tableaux/composition_schemes.h"

namespace isosyrk {

/// step(h) = midpoint(γ_k h) ∘ ... ∘ midpoint(γ_1 h) with fractions γ_i of a CompositionScheme.
/// Isospectral, Lie-Poisson and symmetric, like the midpoint rule.  The step fails if a substep
/// fails.
/// Products and Poisson solves: the sums over the midpoint substeps.
class Composition final : public Integrator {
 public:
  /// Throws std::invalid_argument unless the fractions are symmetric and sum to 1.
  Composition(const Flow& flow, const CompositionScheme& scheme, const SolverOptions& options,
              ProductBackend backend);

 protected:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) override;

 private:
  std::vector<double> fractions_;
  IsospectralMidpoint midpoint_;
};

}  // namespace isosyrk
