#include "isosyrk/integrators/composition.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {

template <class Scalar>
Composition<Scalar>::Composition(SharedFlowIn<Scalar> flow, const CompositionScheme& scheme,
                                 Formulation formulation, const IterationOptions& options,
                                 ProductBackend backend)
    : Composition(
          flow, scheme,
          make_formulation_in<Scalar>(formulation, flow, gauss_tableau(1), options, backend)) {}

template <class Scalar>
Composition<Scalar>::Composition(SharedFlowIn<Scalar> flow, const CompositionScheme& scheme,
                                 std::unique_ptr<IntegratorIn<Scalar>> substep)
    : IntegratorIn<Scalar>(flow),
      fractions_(scheme.fractions),
      substep_(std::move(substep)),
      state_(flow->algebra().template zero<Scalar>()) {
  substep_->make_inner();
  const double sum = std::accumulate(fractions_.begin(), fractions_.end(), 0.0);
  if (std::abs(sum - 1.0) > 1e-14 ||
      !std::equal(fractions_.begin(), fractions_.end(), fractions_.rbegin())) {
    throw std::invalid_argument(
        fmt::format("composition {}: fractions must be symmetric and sum to 1", scheme.name));
  }
}

template <class Scalar>
StepReport Composition<Scalar>::advance(const Stored& W0, double h, Stored& W1) {
  state_ = W0;
  StepReport total;
  for (const double fraction : fractions_) {
    total.append(substep_->advance(state_, fraction * h, W1));
    if (total.status != Status::converged) break;
    state_ = W1;
  }
  return total;
}

template <class Scalar>
void Composition<Scalar>::set_scale(double scale) {
  IntegratorIn<Scalar>::set_scale(scale);
  substep_->set_scale(scale);
}

template class Composition<double>;
template class Composition<Complex>;

}  // namespace isosyrk
