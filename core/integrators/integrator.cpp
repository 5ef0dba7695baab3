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
    : flow_(flow), W0_(flow.size(), flow.size()), W1_(flow.size(), flow.size()) {}

StepReport Integrator::step(MatrixView W, double h) {
  const Index n = flow_.size();
  if (W.rows() != n || W.cols() != n) {
    throw std::invalid_argument(
        fmt::format("step: W is {} x {}, must be {} x {}", W.rows(), W.cols(), n, n));
  }
  if (!std::isfinite(h))
    throw std::invalid_argument(fmt::format("step: h = {}, must be finite", h));

  W0_ = W;
  StepReport report = advance(W0_, h, W1_);
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !W1_.allFinite()) report.status = Status::diverged;
  if (report.status == Status::converged) W = W1_;
  return report;
}

}  // namespace isosyrk
