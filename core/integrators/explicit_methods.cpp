#include "isosyrk/integrators/explicit_methods.h"

#include "isosyrk/integrators/stage_equations.h"

namespace isosyrk {

template <class Scalar>
MuntheKaas4<Scalar>::MuntheKaas4(SharedFlowIn<Scalar> flow, ProductBackend backend)
    : Form(std::move(flow), backend), scheme_(munthe_kaas4()), series_(algebra()) {
  k_ = zeros(scheme_.tableau.stages());
  commutator_ = Omega_ = W_stage_ = zero();
}

// Sets Omega_ to Ω_i of a stage, or to Ω for stage s.
template <class Scalar>
void MuntheKaas4<Scalar>::form_exponent(std::size_t stage) {
  Omega_.setZero();
  if (stage < k_.size()) {
    add_slopes(scheme_.tableau.a.row(static_cast<Index>(stage)), k_, Omega_);
  } else {
    add_slopes(scheme_.tableau.b, k_, Omega_);
  }
  for (const auto& each : scheme_.commutators) {
    if (each.stage != stage) continue;
    series_.commutator(products_, k_[each.left], k_[each.right], commutator_);
    Omega_ += each.weight * commutator_;
  }
}

template <class Scalar>
StepReport MuntheKaas4<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  bool summed = true;
  for (std::size_t i = 0; i < k_.size(); ++i) {
    if (i == 0) {
      W_stage_ = W0;
    } else {
      form_exponent(i);
      summed = series_.conjugate(products_, 1.0, Omega_, W0, W_stage_) && summed;
    }
    generator(W_stage_, k_[i]);
    k_[i] *= h;
  }
  form_exponent(k_.size());
  summed = series_.conjugate(products_, 1.0, Omega_, W0, W1) && summed;
  return {.status = summed ? Status::converged : Status::diverged};
}

template <class Scalar>
ExplicitRungeKutta<Scalar>::ExplicitRungeKutta(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                                               ProductBackend backend)
    : Form(std::move(flow), backend), tableau_(tableau), series_(algebra()) {
  require_explicit(tableau_);
  k_ = zeros(tableau_.stages());
  B_ = W_stage_ = zero();
}

template <class Scalar>
void ExplicitRungeKutta<Scalar>::slope(const Stored& W, Stored& k) {
  generator(W, B_);
  series_.commutator(products_, B_, W, k);
}

template <class Scalar>
StepReport ExplicitRungeKutta<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  for (std::size_t i = 0; i < k_.size(); ++i) {
    W_stage_ = W0;
    add_slopes(h * tableau_.a.row(static_cast<Index>(i)), k_, W_stage_);
    slope(W_stage_, k_[i]);
  }
  W1 = W0;
  add_slopes(h * tableau_.b, k_, W1);
  return {};
}

template <class Scalar>
AdamsBashforthMoulton<Scalar>::AdamsBashforthMoulton(SharedFlowIn<Scalar> flow,
                                                     const MultistepScheme& scheme,
                                                     ProductBackend backend)
    : Form(std::move(flow), scheme.start, backend),
      scheme_(scheme),
      past_(zeros(scheme.predictor.size())) {
  predicted_ = predicted_slope_ = zero();
}

template <class Scalar>
StepReport AdamsBashforthMoulton<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  if (is_alone()) return Form::take_step(W0, h, W1);
  Stored& f = past_.join(h);
  if (!past_.is_complete()) {
    const StepReport report = Form::take_step(W0, h, W1);
    f = first_slope();
    return report;
  }
  slope(W0, f);
  predicted_ = W0;
  add_slopes(h * scheme_.predictor, past_.slopes(), predicted_);
  slope(predicted_, predicted_slope_);
  W1 = W0 + h * scheme_.of_predicted * predicted_slope_;
  add_slopes(h * scheme_.corrector, past_.slopes(), W1);
  return {};
}

template class MuntheKaas4<double>;
template class MuntheKaas4<Complex>;
template class ExplicitRungeKutta<double>;
template class ExplicitRungeKutta<Complex>;
template class AdamsBashforthMoulton<double>;
template class AdamsBashforthMoulton<Complex>;

}  // namespace isosyrk
