#include "core/composition.h"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

namespace isosyrk {

CompositionScheme yoshida4() {
  const double outer = 1.0 / (2.0 - std::cbrt(2.0));
  return {"yoshida4", 4, {outer, 1.0 - 2.0 * outer, outer}};
}

CompositionScheme suzuki4() {
  const double outer = 1.0 / (4.0 - std::cbrt(4.0));
  return {"suzuki4", 4, {outer, outer, 1.0 - 4.0 * outer, outer, outer}};
}

CompositionScheme kahan_li6() {
  const double a = 0.39216144400731413928;
  const double b = 0.33259913678935943860;
  const double c = -0.70624617255763935981;
  const double d = 0.082213596293550800230;
  const double e = 0.79854399093482996340;
  return {"kahan_li6", 6, {a, b, c, d, e, d, c, b, a}};
}

Composition::Composition(const Flow& flow, const CompositionScheme& scheme,
                         const SolverOptions& options, ProductBackend backend)
    : Integrator(flow, backend), fractions_(scheme.fractions), midpoint_(flow, options, backend) {
  const double sum = std::accumulate(fractions_.begin(), fractions_.end(), 0.0);
  if (std::abs(sum - 1.0) > 1e-14 ||
      !std::equal(fractions_.begin(), fractions_.end(), fractions_.rbegin())) {
    throw std::invalid_argument(
        fmt::format("composition {}: fractions must be symmetric and sum to 1", scheme.name));
  }
}

SolveReport Composition::advance(const Matrix& W0, double h, Matrix& W1) {
  W1 = W0;
  SolveReport total;
  for (const double fraction : fractions_) {
    const StepReport substep = midpoint_.step(W1, fraction * h);
    add_work(substep);
    total.sweeps += substep.sweeps;
    total.change = substep.last_change;
    total.contraction = larger(total.contraction, substep.contraction);
    total.status = substep.status;
    if (substep.status != Status::converged) break;
  }
  return total;
}

}  // namespace isosyrk
