#include "isosyrk/integrators/integrator.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "isosyrk/integrators/state_trace.h"

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

// W + icI.
void add_to_trace(MatrixView W, double c) { W.diagonal().array() += Complex(0.0, c); }

SharedFlow present(SharedFlow flow) {
  if (flow == nullptr) throw std::invalid_argument("integrator: flow is null");
  return flow;
}

}  // namespace

Integrator::Integrator(SharedFlow flow)
    : flow_(present(std::move(flow))),
      known_(Matrix::Zero(flow_->size(), flow_->size())),
      diagonal_(flow_->size()) {}

void Integrator::make_inner() {
  is_inner_ = true;
  is_known_ = false;
  known_.resize(0, 0);
}

// Returns the c that is to be set aside.
double Integrator::trace_of(const ConstMatrixView& W) const {
  return !is_inner_ && flow_->ignores_trace() ? trace_part(W) : 0.0;
}

// Calls take(V) for a W that is not known.
template <class Take>
void Integrator::change_state(const ConstMatrixView& W, const Take& take) {
  require_size(W, flow_->size());
  if (is_inner_) return take(W);
  if (is_known_ && W == known_) return;
  const double trace = trace_of(W);
  if (trace == 0.0) {
    take(W);
  } else {
    is_known_ = false;
    known_ = W;
    add_to_trace(known_, -trace);
    take(known_);
  }
  trace_ = trace;
  known_ = W;
  is_known_ = true;
}

void Integrator::set_state(const ConstMatrixView& W) {
  change_state(W, [&](const ConstMatrixView& V) { load(V); });
}

void Integrator::amend_state(const ConstMatrixView& W) {
  change_state(W, [&](const ConstMatrixView& V) { amend(V); });
}

StepReport Integrator::step(double h) {
  require_finite(h);
  const StepReport report = advance_state(h);
  if (report.status == Status::converged) is_known_ = false;
  return report;
}

void Integrator::state(MatrixView W) const {
  if (is_inner_) return store(W);
  if (!is_known_) {
    store(known_);
    if (trace_ != 0.0) add_to_trace(known_, trace_);
    is_known_ = true;
  }
  W = known_;
}

Matrix Integrator::state() const {
  Matrix W(flow_->size(), flow_->size());
  state(W);
  return W;
}

StepReport Integrator::step(MatrixView W, double h) {
  require_size(W, flow_->size());
  require_finite(h);
  const double trace = trace_of(W);
  if (trace == 0.0) return step_alone(W, h);

  diagonal_ = W.diagonal();
  add_to_trace(W, -trace);
  StepReport report;
  try {
    report = step_alone(W, h);
  } catch (...) {
    W.diagonal() = diagonal_;
    throw;
  }
  if (report.status == Status::converged) {
    add_to_trace(W, trace);
  } else {
    W.diagonal() = diagonal_;
  }
  return report;
}

void Integrator::archive(StateArchive& run) {
  if (run.is_reading()) is_known_ = false;
  bool is_known = is_known_;
  run.pass(trace_, is_known);
  if (is_known) run.pass(known_);
  archive_run(run);
  is_known_ = is_known;
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
  forget();
  take(finder_.find(W));
}

template <class Scalar>
void IntegratorIn<Scalar>::amend(const ConstMatrixView& W) {
  flow_.algebra().pack(W, next_);
  forget();
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
    is_alone_ = !is_alone_;
  });
  return advance_state(h);
}

template <class Scalar>
void IntegratorIn<Scalar>::archive_run(StateArchive& run) {
  run.pass(found_, state_);
  set_scale(found_.value);
  archive_past(run);
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
  if (scale_ == 1.0 || flow_.kind() == Generator::linear) {
    generate(flow_.argument(V, argument_), B);
  } else {
    flow_.argument(V, argument_);
    argument_ *= scale_;
    generate(argument_, B);
  }
}

template <class Scalar>
double IntegratorIn<Scalar>::rotation_left_out(const Stored& V) const {
  if constexpr (std::is_same_v<Scalar, double>) {
    return 0.0;
  } else {
    return flow_.rotation_left_out(V);
  }
}

template <class Scalar>
Energy IntegratorIn<Scalar>::energy() const {
  return flow_.stored_energy(state_, std::ilogb(scale_));
}

template <class Scalar>
StepReport IntegratorIn<Scalar>::advance_state(double h) {
  // V' = [B(V), V] in the time scale t, if B is linear.  B(scale V) in its place would overflow in
  // products of two.
  const bool is_linear = flow_.kind() == Generator::linear;
  StepReport report = advance(state_, is_linear ? scale_ * h : h, next_);
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !next_.allFinite()) report.status = Status::diverged;
  if (report.status == Status::converged) {
    state_.swap(next_);
  } else if (!is_alone_) {
    forget();
  }
  return report;
}

template class IntegratorIn<double>;
template class IntegratorIn<Complex>;

}  // namespace isosyrk
