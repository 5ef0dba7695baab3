#include "isosyrk/integrators/integrator.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

void StepReport::append(const StepReport& substep) {
  status = substep.status;
  attempt = substep.attempt;
  sweeps += substep.sweeps;
  last_change = substep.last_change;
  contraction = larger(contraction, substep.contraction);
  products += substep.products;
  poisson_solves += substep.poisson_solves;
  equivalent_products += substep.equivalent_products;
}

void StepReport::set_work(const StepReport& before, const StepReport& after) {
  products = after.products - before.products;
  poisson_solves = after.poisson_solves - before.poisson_solves;
  equivalent_products = after.equivalent_products - before.equivalent_products;
}

void Integrator::set_state(const MatrixView& W) {
  const Index n = flow_.size();
  if (W.rows() != n || W.cols() != n) {
    throw std::invalid_argument(
        fmt::format("step: W is {} x {}, must be {} x {}", W.rows(), W.cols(), n, n));
  }
  load(W);
}

StepReport Integrator::step(double h) {
  if (!std::isfinite(h))
    throw std::invalid_argument(fmt::format("step: h = {}, must be finite", h));
  return advance_state(h);
}

StepReport Integrator::step(MatrixView W, double h) {
  set_state(W);
  const StepReport report = step(h);
  if (report.status == Status::converged) state(W);
  return report;
}

template <class Scalar>
IntegratorIn<Scalar>::IntegratorIn(const FlowIn<Scalar>& flow)
    : Integrator(flow),
      flow_(flow),
      state_(flow.algebra().template zero<Scalar>()),
      next_(state_) {}

template <class Scalar>
void IntegratorIn<Scalar>::evaluate(const Stored& W, Stored& B) const {
  if constexpr (std::is_same_v<Scalar, double>) {
    flow_.real_generator(W, B);
  } else {
    flow_.generator(W, B);
  }
}

template <class Scalar>
double IntegratorIn<Scalar>::energy() {
  if constexpr (std::is_same_v<Scalar, double>) {
    return flow_.real_hamiltonian(state_);
  } else {
    return flow_.hamiltonian(state_);
  }
}

template <class Scalar>
StepReport IntegratorIn<Scalar>::advance_state(double h) {
  StepReport report = advance(state_, h, next_);
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !next_.allFinite()) report.status = Status::diverged;
  if (report.status == Status::converged) state_.swap(next_);
  return report;
}

template class IntegratorIn<double>;
template class IntegratorIn<Complex>;

}  // namespace isosyrk
