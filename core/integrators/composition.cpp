#include "isosyrk/integrators/composition.h"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

namespace isosyrk {

Composition::Composition(const Flow& flow, const CompositionScheme& scheme,
                         const SolverOptions& options, ProductBackend backend)
    : Integrator(flow), fractions_(scheme.fractions), midpoint_(flow, options, backend) {
  const double sum = std::accumulate(fractions_.begin(), fractions_.end(), 0.0);
  if (std::abs(sum - 1.0) > 1e-14 ||
      !std::equal(fractions_.begin(), fractions_.end(), fractions_.rbegin())) {
    throw std::invalid_argument(
        fmt::format("composition {}: fractions must be symmetric and sum to 1", scheme.name));
  }
}

StepReport Composition::advance(const Matrix& W0, double h, Matrix& W1) {
  W1 = W0;
  StepReport total;
  for (const double fraction : fractions_) {
    total.append(midpoint_.step(W1, fraction * h));
    if (total.status != Status::converged) break;
  }
  return total;
}

}  // namespace isosyrk
