// Symmetric compositions of the isospectral midpoint rule: the isospectral symplectic DIRK methods
// of the paper's footnote.
#pragma once

#include <vector>

#include "isosyrk/integrators/isospectral_midpoint.h"
#include "isosyrk/tableaux/composition_schemes.h"

namespace isosyrk {

/// Isospectral, Lie-Poisson and symmetric, as the midpoint rule is.
/// Products and Poisson solves: those of the midpoint substeps.
class Composition final : public Integrator {
 public:
  /// Throws std::invalid_argument unless the fractions are symmetric and sum to 1.
  Composition(const Flow& flow, const CompositionScheme& scheme, const SolverOptions& options,
              ProductBackend backend);

  /// The n x n complex matrices that it holds where J = I.
  static Index matrices() { return common_matrices + IsospectralMidpoint::matrices(); }

 protected:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) override;

 private:
  std::vector<double> fractions_;
  IsospectralMidpoint midpoint_;
};

}  // namespace isosyrk
