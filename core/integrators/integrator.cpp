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
  work += substep.work;
}

namespace {

void require_size(const ConstMatrixView& W, Index n) {
  if (W.rows() != n || W.cols() != n) {
    throw std::invalid_argument(
        fmt::format("step: W is {} x {}, must be {} x {}", W.rows(), W.cols(), n, n));
  }
}

void require_finite(double h) {
  if (!std::isfinite(h))
    throw std::invalid_argument(fmt::format("step: h = {}, must be finite", h));
}

}  // namespace

Integrator::Integrator(SharedFlow flow) : flow_(std::move(flow)) {
  if (flow_ == nullptr) throw std::invalid_argument("integrator: flow is null");
}

void Integrator::set_state(const ConstMatrixView& W) {
  require_size(W, flow_->size());
  load(W);
}

void Integrator::amend_state(const ConstMatrixView& W) {
  require_size(W, flow_->size());
  amend(W);
}

StepReport Integrator::step(double h) {
  require_finite(h);
  return advance_state(h);
}

Matrix Integrator::state() const {
  Matrix W(flow_->size(), flow_->size());
  store(W);
  return W;
}

StepReport Integrator::step(MatrixView W, double h) {
  require_size(W, flow_->size());
  require_finite(h);
  return step_alone(W, h);
}

template <class Scalar>
IntegratorIn<Scalar>::IntegratorIn(SharedFlowIn<Scalar> flow)
    : Integrator(flow),
      flow_(*flow),
      finder_(flow->size()),
      state_(flow->algebra().template zero<Scalar>()),
      next_(state_) {
  if (flow_.kind() != Generator::linear) argument_ = state_;
}

// Takes the W in next_ as the state.
template <class Scalar>
void IntegratorIn<Scalar>::take(const StateScale& found) {
  found_ = found;
  set_scale(found.value);
  if (scale_ != 1.0) next_ *= 1.0 / scale_;
  state_.swap(next_);
}

template <class Scalar>
void IntegratorIn<Scalar>::load(const ConstMatrixView& W) {
  flow_.algebra().pack(W, next_);  // may throw halfway
  take(finder_.find(W));
}

template <class Scalar>
void IntegratorIn<Scalar>::amend(const ConstMatrixView& W) {
  flow_.algebra().pack(W, next_);
  take(ScaleFinder::changed_twofold(found_, W) ? finder_.find(W) : found_);
}

template <class Scalar>
void IntegratorIn<Scalar>::store(MatrixView W) const {
  flow_.algebra().unpack(state_, W);
  if (scale_ != 1.0) W *= scale_;
}

// Exchanges the state with W.
template <class Scalar>
void IntegratorIn<Scalar>::exchange(MatrixView W, const StateScale& of_W) {
  flow_.algebra().pack(W, next_);
  store(W);
  take(of_W);
}

// W keeps the state of a run meanwhile, so that no workspace is needed for it.
template <class Scalar>
StepReport IntegratorIn<Scalar>::step_alone(MatrixView W, double h) {
  StateScale other = finder_.find(W);
  const Exchanged exchanged([&] {
    const StateScale mine = found_;
    exchange(W, other);
    other = mine;
  });
  return advance_state(h);
}

template <class Scalar>
void IntegratorIn<Scalar>::generate(const Stored& W, Stored& B) const {
  if constexpr (std::is_same_v<Scalar, double>) {
    flow_.real_generator(W, B);
  } else {
    flow_.generator(W, B);
  }
}

template <class Scalar>
void IntegratorIn<Scalar>::evaluate(const Stored& V, Stored& B) {
  if (scale_ == 1.0) {
    generate(flow_.argument(V, argument_), B);
  } else if (flow_.kind() == Generator::linear) {
    generate(V, B);
    B *= scale_;
  } else {
    flow_.argument(V, argument_);
    argument_ *= scale_;
    generate(argument_, B);
  }
}

template <class Scalar>
double IntegratorIn<Scalar>::energy() const {
  const Stored W = scale_ * state_;
  if constexpr (std::is_same_v<Scalar, double>) {
    return flow_.real_hamiltonian(W);
  } else {
    return flow_.hamiltonian(W);
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
