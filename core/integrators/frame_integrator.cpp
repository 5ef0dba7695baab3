#include "isosyrk/integrators/frame_integrator.h"

#include <stdexcept>

namespace isosyrk {
namespace {

std::shared_ptr<const EulerZeitlin> euler_zeitlin(const SharedFlow& flow) {
  if (auto found = std::dynamic_pointer_cast<const EulerZeitlin>(flow)) return found;
  throw std::invalid_argument("co-rotating frame: for Euler-Zeitlin only");
}

}  // namespace

FrameIntegrator::FrameIntegrator(const SharedFlow& flow, const Make& make, int threads)
    : Integrator(flow),
      frame_(euler_zeitlin(flow), threads),
      V_(flow->size(), flow->size()),
      method_(make(frame_.flow())) {
  method_->make_inner();
}

Energy FrameIntegrator::energy() const {
  method_->state(V_);
  return flow().energy(V_);
}

void FrameIntegrator::load(const ConstMatrixView& W) {
  method_->set_state(W);
  method_->state(V_);
  rate_ = frame_.rate(V_);
  U_ = {};
  past_ = h_ = 0.0;
  steps_ = 0;
}

// B' turns with V, so that V obeys the same equation from whatever angle it is seen.
void FrameIntegrator::amend(const ConstMatrixView& W) {
  const SpinRotation U = turned();
  V_ = W;
  const CoRotatingFrame::Rate rate = frame_.rate(V_);
  frame_.turn(U.inverse(), V_, V_);
  method_->amend_state(V_);
  U_ = U.normalized();
  rate_ = rate;
  past_ = h_ = 0.0;
  steps_ = 0;
}

// Returns how far the frame has turned since the state was set.
SpinRotation FrameIntegrator::turned() const {
  return CoRotatingFrame::rotation(rate_, past_ + h_ * static_cast<double>(steps_)).after(U_);
}

StepReport FrameIntegrator::advance_state(double h) {
  const StepReport report = method_->step(h);
  if (report.status != Status::converged) return report;
  if (h != h_) {
    past_ += h_ * static_cast<double>(steps_);
    h_ = h;
    steps_ = 0;
  }
  ++steps_;
  return report;
}

void FrameIntegrator::archive_run(StateArchive& run) {
  method_->archive(run);
  run.pass(U_.a, U_.b, rate_, past_, h_, steps_);
}

void FrameIntegrator::store(MatrixView W) const {
  method_->state(V_);
  frame_.turn(turned(), V_, W);
}

StepReport FrameIntegrator::step_alone(MatrixView W, double h) {
  V_ = W;
  const CoRotatingFrame::Rate rate = frame_.rate(V_);
  const StepReport report = method_->step(V_, h);
  if (report.status == Status::converged) frame_.leave(rate, h, V_, W);
  return report;
}

}  // namespace isosyrk
