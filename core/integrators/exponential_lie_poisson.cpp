#include "isosyrk/integrators/exponential_lie_poisson.h"

#include <fmt/format.h>

#include <limits>

#include "isosyrk/integrators/flow_requirements.h"

namespace isosyrk {
namespace {

// ‖fresh - old‖_F / ‖fresh‖_F.  0 for a zero that stays: without B or h nothing moves.
template <class Scalar>
double relative_change(const MatrixOf<Scalar>& fresh, const MatrixOf<Scalar>& old) {
  const double change = std::sqrt(squared_change(fresh, old));
  return change == 0.0 ? 0.0 : change / fresh.norm();
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace

template <class Scalar>
ExponentialLiePoisson<Scalar>::ExponentialLiePoisson(SharedFlowIn<Scalar> flow, int order,
                                                     const IterationOptions& options,
                                                     ProductBackend backend)
    : Form(std::move(flow), options, backend),
      rotation_(algebra()),
      gradient_(order, algebra(),
                {[this](const Stored& W, Stored& B) { generator(W, B); },
                 [this](const Stored& A, const Stored& B, Stored& bracket) {
                   rotation_.commutator(products_, A, B, bracket);
                 }}) {
  const std::string name = fmt::format("elp{}", order);
  require_identity_J(this->flow(), name);
  if (order > 2) require_self_adjoint_generator(this->flow(), name);
  Omega_ = Omega_next_ = mu_ = rotated_ = zero();
}

template <class Scalar>
void ExponentialLiePoisson<Scalar>::start(const Stored&) {
  Omega_.setZero();
}

template <class Scalar>
double ExponentialLiePoisson<Scalar>::sweep(const Stored& W0, double h) {
  if (!rotation_.rotate(products_, Omega_, W0, rotated_, mu_)) return not_a_number;
  gradient_.evaluate(mu_, h, Omega_next_);
  Omega_next_ *= h;
  Omega_.swap(Omega_next_);
  return relative_change(Omega_, Omega_next_);
}

template <class Scalar>
void ExponentialLiePoisson<Scalar>::update(const Stored& W0, double, Stored& W1) {
  const bool summed = rotation_.rotate(products_, Omega_, W0, W1, mu_);
  if (!summed) W1.setConstant(not_a_number);  // the step diverges
}

template class ExponentialLiePoisson<double>;
template class ExponentialLiePoisson<Complex>;

}  // namespace isosyrk
