#include "isosyrk/integrators/frame_integrator.h"

#include <stdexcept>

namespace isosyrk {
namespace {

const EulerZeitlin& euler_zeitlin(const Flow& flow) {
  if (const auto* found = dynamic_cast<const EulerZeitlin*>(&flow)) return *found;
  throw std::invalid_argument("co-rotating frame: for Euler-Zeitlin only");
}

}  // namespace

FrameIntegrator::FrameIntegrator(const Flow& flow, const Make& make, ProductBackend backend)
    : Integrator(flow),
      frame_(euler_zeitlin(flow), backend),
      method_(make(frame_.flow())),
      V_(flow.size(), flow.size()) {}

double FrameIntegrator::energy() {
  method_->state(V_);
  return flow().energy(V_);
}

void FrameIntegrator::load(const MatrixView& W) {
  method_->set_state(W);
  method_->state(V_);
  frame_.set(V_);
  past_ = h_ = 0.0;
  steps_ = 0;
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

void FrameIntegrator::store(MatrixView W) {
  method_->state(V_);
  frame_.leave(past_ + h_ * static_cast<double>(steps_), V_, W);
}

}  // namespace isosyrk
