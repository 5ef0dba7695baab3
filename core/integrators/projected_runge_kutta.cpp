#include "isosyrk/integrators/projected_runge_kutta.h"

#include "isosyrk/integrators/explicit_methods.h"
#include "isosyrk/integrators/flow_requirements.h"

namespace isosyrk {

ProjectedRungeKutta4::ProjectedRungeKutta4(const SharedFlow& flow, ProductBackend backend)
    : Integrator(flow),
      method_(make_in_arithmetic_of<ClassicalRungeKutta4>(flow, backend)),
      projection_(flow->algebra(), backend),
      is_real_(dynamic_cast<const RealFlow*>(flow.get()) != nullptr) {
  require_identity_J(*flow, "rk4_projected");
  W_ = next_ = Matrix::Zero(flow->size(), flow->size());
  eigenvalues_ = eigenvalues_alone_ = RealVector::Zero(flow->size());
}

void ProjectedRungeKutta4::load(const ConstMatrixView& W) {
  method_->set_state(W);  // refuses what storage cannot hold
  W_ = W;
  projection_.find_spectrum(W_, eigenvalues_);  // NaN where there is none: the next step diverges
}

// Sets next_ to the state after a step from W.
StepReport ProjectedRungeKutta4::step_from(const ConstMatrixView& W, const RealVector& eigenvalues,
                                           double h) {
  next_ = W;
  StepReport report = method_->step(next_, h);
  if (report.status != Status::converged) return report;
  if (!projection_.project(eigenvalues, next_)) report.status = Status::diverged;
  if (is_real_) next_.imag().setZero();  // rounding of complex eigenvectors
  report.work += {.products = SpectralProjection::products,
                  .equivalent_products = SpectralProjection::products};
  return report;
}

StepReport ProjectedRungeKutta4::advance_state(double h) {
  const StepReport report = step_from(W_, eigenvalues_, h);
  if (report.status == Status::converged) W_.swap(next_);
  return report;
}

StepReport ProjectedRungeKutta4::step_alone(MatrixView W, double h) {
  next_ = W;
  projection_.find_spectrum(next_, eigenvalues_alone_);
  const StepReport report = step_from(W, eigenvalues_alone_, h);
  if (report.status == Status::converged) W = next_;
  return report;
}

}  // namespace isosyrk
