#include "isosyrk/integrators/integrator.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

Integrator::Integrator(const Flow& flow, ProductBackend backend)
    : flow_(flow), products_(backend, flow.size()), next_(flow.size(), flow.size()) {}

StepReport Integrator::step(Matrix& W, double h) {
  const Index n = flow_.size();
  if (W.rows() != n || W.cols() != n) {
    throw std::invalid_argument(
        fmt::format("step: W is {} x {}, must be {} x {}", W.rows(), W.cols(), n, n));
  }
  if (!std::isfinite(h))
    throw std::invalid_argument(fmt::format("step: h = {}, must be finite", h));

  const long products_before = products();
  const long solves_before = poisson_solves_;
  const double equivalents_before = equivalents();
  SolveReport solve = advance(W, h, next_);
  // Stages can converge and the update still overflow.
  if (solve.status == Status::converged && !next_.allFinite()) solve.status = Status::diverged;
  if (solve.status == Status::converged) W.swap(next_);
  return {.status = solve.status,
          .sweeps = solve.sweeps,
          .last_change = solve.change,
          .contraction = solve.contraction,
          .products = products() - products_before,
          .poisson_solves = poisson_solves_ - solves_before,
          .equivalent_products = equivalents() - equivalents_before};
}

}  // namespace isosyrk
