#include "isosyrk/integrators/explicit_methods.h"

namespace isosyrk {

template <class Scalar>
MuntheKaas4<Scalar>::MuntheKaas4(SharedFlowIn<Scalar> flow, ProductBackend backend)
    : Form(std::move(flow), backend), series_(algebra()) {
  commutator_ = Omega_ = W_stage_ = zero();
  k_.fill(commutator_);
}

template <class Scalar>
StepReport MuntheKaas4<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  bool summed = true;
  const auto stage = [&](double scale, const Stored& exponent, Stored& k) {
    summed = series_.conjugate(products_, scale, exponent, W0, W_stage_) && summed;
    generator(W_stage_, k);
    k *= h;
  };
  generator(W0, k_[0]);
  k_[0] *= h;
  stage(0.5, k_[0], k_[1]);
  series_.commutator(products_, k_[0], k_[1], commutator_);
  Omega_ = 0.5 * k_[1] - 0.125 * commutator_;
  stage(1.0, Omega_, k_[2]);
  stage(1.0, k_[2], k_[3]);
  series_.commutator(products_, k_[0], k_[3], commutator_);
  Omega_ = (k_[0] + 2.0 * k_[1] + 2.0 * k_[2] + k_[3]) / 6.0 - commutator_ / 12.0;
  summed = series_.conjugate(products_, 1.0, Omega_, W0, W1) && summed;
  return {.status = summed ? Status::converged : Status::diverged};
}

template <class Scalar>
ClassicalRungeKutta4<Scalar>::ClassicalRungeKutta4(SharedFlowIn<Scalar> flow,
                                                   ProductBackend backend)
    : Form(std::move(flow), backend), series_(algebra()) {
  B_ = W_stage_ = zero();
  k_.fill(B_);
}

template <class Scalar>
void ClassicalRungeKutta4<Scalar>::slope(const Stored& W, Stored& out) {
  generator(W, B_);
  series_.commutator(products_, B_, W, out);
}

template <class Scalar>
StepReport ClassicalRungeKutta4<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  slope(W0, k_[0]);
  W_stage_ = W0 + (0.5 * h) * k_[0];
  slope(W_stage_, k_[1]);
  W_stage_ = W0 + (0.5 * h) * k_[1];
  slope(W_stage_, k_[2]);
  W_stage_ = W0 + h * k_[2];
  slope(W_stage_, k_[3]);
  W1 = W0 + (h / 6.0) * (k_[0] + 2.0 * k_[1] + 2.0 * k_[2] + k_[3]);
  return {};
}

template class MuntheKaas4<double>;
template class MuntheKaas4<Complex>;
template class ClassicalRungeKutta4<double>;
template class ClassicalRungeKutta4<Complex>;

}  // namespace isosyrk
