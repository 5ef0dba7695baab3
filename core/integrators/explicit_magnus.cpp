#include "isosyrk/integrators/explicit_magnus.h"

#include "isosyrk/integrators/flow_requirements.h"
#include "isosyrk/integrators/stage_equations.h"

namespace isosyrk {

template <class Scalar>
ExplicitMagnus<Scalar>::ExplicitMagnus(SharedFlowIn<Scalar> flow, std::string_view name,
                                       ProductBackend backend)
    : Form(std::move(flow), backend),
      rotation_(algebra()),
      is_linear_(this->flow().kind() == Generator::linear),
      tableau_(classical_runge_kutta4().tableau) {
  require_identity_J(this->flow(), name);
  Omega_ = B_stage_ = W_stage_ = zero();
  k_ = this->zeros(tableau_.stages());
}

template <class Scalar>
StepReport ExplicitMagnus<Scalar>::take_step(const Stored& W0, double h, Stored& W1) {
  form_Omega(W0, h);
  const bool summed = rotation_.rotate(products_, Omega_, W0, W1, W_stage_);
  return {.status = summed ? Status::converged : Status::diverged};
}

template <class Scalar>
void ExplicitMagnus<Scalar>::evaluate_at(const Stored& W, Point& point) {
  point.W = W;
  generator(point.W, point.B);
  bracket(point.B, point.W, point.k);
  if (is_linear_) {
    generator(point.k, point.D);
  } else {
    differentiate(point);
  }
}

// D = (8 (B(W + εk) - B(W - εk)) - (B(W + 2εk) - B(W - 2εk))) / (12ε), exact to O(ε⁴).
template <class Scalar>
void ExplicitMagnus<Scalar>::differentiate(Point& point) {
  constexpr double part = 1e-3;  // of ‖W‖: balances ε⁴ with rounding / ε
  const double size = point.k.norm();
  point.D.setZero();
  if (!(size > 0.0)) return;
  const double epsilon = part * point.W.norm() / size;
  for (const auto& [shift, weight] :
       {std::pair{1.0, 8.0}, {-1.0, -8.0}, {2.0, -1.0}, {-2.0, 1.0}}) {
    W_stage_ = point.W + (shift * epsilon) * point.k;
    generator(W_stage_, B_stage_);
    point.D += (weight / (12.0 * epsilon)) * B_stage_;
  }
}

template <class Scalar>
void ExplicitMagnus<Scalar>::predict(const Point& from, double h, Stored& W) {
  k_[0] = from.k;
  for (std::size_t i = 1; i < k_.size(); ++i) {
    W_stage_ = from.W;
    add_slopes(h * tableau_.a.row(static_cast<Index>(i)), k_, W_stage_);
    generator(W_stage_, B_stage_);
    bracket(B_stage_, W_stage_, k_[i]);
  }
  W = from.W;
  add_slopes(h * tableau_.b, k_, W);
}

template <class Scalar>
ExplicitMagnus4<Scalar>::ExplicitMagnus4(SharedFlowIn<Scalar> flow, ProductBackend backend)
    : Form(std::move(flow), "magnus4", backend) {
  start_ = end_ = this->point();
  a0_ = a1_ = this->zero();
}

template <class Scalar>
void ExplicitMagnus4<Scalar>::form_Omega(const Stored& W0, double h) {
  evaluate_at(W0, start_);
  predict(start_, h, Omega_);
  evaluate_at(Omega_, end_);
  const Stored &B0 = start_.B, &D0 = start_.D;
  const Stored &B1 = end_.B, &D1 = end_.D;
  a0_ = (h / 2.0) * (B0 + B1) + (h * h / 12.0) * (D0 - D1);
  a1_ = (h / 10.0) * (B1 - B0) - (h * h / 120.0) * (D0 + D1);
  bracket(a0_, a1_, Omega_);
  Omega_ = a0_ - Omega_;
}

template <class Scalar>
ExplicitMagnus5<Scalar>::ExplicitMagnus5(SharedFlowIn<Scalar> flow, ProductBackend backend)
    : Form(std::move(flow), "magnus5", backend) {
  start_ = middle_ = end_ = this->point();
  m0_ = m1_ = m2_ = alpha1_ = alpha2_ = alpha3_ = C1_ = C2_ = left_ = right_ = this->zero();
}

template <class Scalar>
void ExplicitMagnus5<Scalar>::form_Omega(const Stored& W0, double h) {
  evaluate_at(W0, start_);
  predict(start_, 0.5 * h, Omega_);
  evaluate_at(Omega_, middle_);
  predict(middle_, 0.5 * h, Omega_);
  evaluate_at(Omega_, end_);
  const Stored &b0 = start_.B, &bm = middle_.B, &b1 = end_.B;
  start_.D *= h;
  middle_.D *= h;
  end_.D *= h;
  const Stored &d0 = start_.D, &dm = middle_.D, &d1 = end_.D;

  m0_ = (h / 60.0) * (14.0 * b0 + 32.0 * bm + 14.0 * b1 + d0 - d1);
  m1_ = (h / 840.0) * (60.0 * (b1 - b0) - 3.0 * d0 + 16.0 * dm - 3.0 * d1);
  m2_ = (h / 1680.0) * (54.0 * b0 + 32.0 * bm + 54.0 * b1 + 3.0 * d0 - 3.0 * d1);
  alpha2_ = 12.0 * m1_;
  alpha3_ = 180.0 * m2_ - 15.0 * m0_;
  alpha1_ = m0_ - alpha3_ / 12.0;

  bracket(alpha1_, alpha2_, C1_);
  left_ = 2.0 * alpha3_ + C1_;
  bracket(alpha1_, left_, C2_);
  C2_ *= -1.0 / 60.0;
  left_ = C1_ - 20.0 * alpha1_ - alpha3_;
  right_ = alpha2_ + C2_;
  bracket(left_, right_, Omega_);
  Omega_ = alpha1_ + alpha3_ / 12.0 + Omega_ / 240.0;
}

template class ExplicitMagnus<double>;
template class ExplicitMagnus<Complex>;
template class ExplicitMagnus4<double>;
template class ExplicitMagnus4<Complex>;
template class ExplicitMagnus5<double>;
template class ExplicitMagnus5<Complex>;

}  // namespace isosyrk
