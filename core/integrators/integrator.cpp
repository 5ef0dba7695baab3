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

Integrator::Integrator(const Flow& flow)
    : flow_(flow), state_(flow.size(), flow.size()), next_(flow.size(), flow.size()) {}

void Integrator::enter(const Matrix&) {}

void Integrator::leave(double, const Matrix& V, MatrixView W) { W = V; }

void Integrator::set_state(const MatrixView& W) {
  const Index n = flow_.size();
  if (W.rows() != n || W.cols() != n) {
    throw std::invalid_argument(
        fmt::format("step: W is {} x {}, must be {} x {}", W.rows(), W.cols(), n, n));
  }
  state_ = W;
  past_ = h_ = 0.0;
  steps_ = 0;
  enter(state_);
}

StepReport Integrator::step(double h) {
  if (!std::isfinite(h))
    throw std::invalid_argument(fmt::format("step: h = {}, must be finite", h));
  StepReport report = advance(state_, h, next_);
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !next_.allFinite()) report.status = Status::diverged;
  if (report.status != Status::converged) return report;
  state_.swap(next_);
  if (h != h_) {
    past_ += h_ * static_cast<double>(steps_);
    h_ = h;
    steps_ = 0;
  }
  ++steps_;
  return report;
}

void Integrator::state(MatrixView W) { leave(past_ + h_ * static_cast<double>(steps_), state_, W); }

StepReport Integrator::step(MatrixView W, double h) {
  set_state(W);
  const StepReport report = step(h);
  if (report.status == Status::converged) state(W);
  return report;
}

}  // namespace isosyrk
