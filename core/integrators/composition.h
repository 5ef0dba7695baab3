// Symmetric compositions, above all of the midpoint rule in one of the formulations.  These are the
// isospectral symplectic DIRK methods of the paper's footnote.
#pragma once

#include <vector>

#include "isosyrk/integrators/formulation.h"
#include "isosyrk/tableaux/composition_schemes.h"

namespace isosyrk {

/// step(h) = midpoint(γ_k h) ∘ ... ∘ midpoint(γ_1 h) with fractions γ_i of a CompositionScheme.
/// Midpoint is one of CotangentForm, GroupForm, which take the midpoint tableau, and
/// IsospectralMidpoint.  Isospectral, Lie-Poisson and symmetric, like the midpoint rule.  The step
/// fails if a substep fails.
/// Products and Poisson solves: the sums over the substeps.
template <class Scalar>
class Composition : public IntegratorIn<Scalar> {
 public:
  using typename IntegratorIn<Scalar>::Stored;

  /// Throws std::invalid_argument unless the fractions are symmetric and sum to 1.
  Composition(SharedFlowIn<Scalar> flow, const CompositionScheme& scheme, Formulation formulation,
              const IterationOptions& options, ProductBackend backend);
  /// Composes steps of another symmetric method in place of the midpoint rule.  Throws likewise.
  Composition(SharedFlowIn<Scalar> flow, const CompositionScheme& scheme,
              std::unique_ptr<IntegratorIn<Scalar>> substep);

  StepReport advance(const Stored& W0, double h, Stored& W1) override;
  void set_scale(double scale) override;

 private:
  std::vector<double> fractions_;
  std::unique_ptr<IntegratorIn<Scalar>> substep_;
  Stored state_;
};

}  // namespace isosyrk
