#include "isosyrk/fast/split_magnus.h"

namespace isosyrk {

template <class Real>
SplitMagnus<Real>::SplitMagnus(SplitLie<Real>& lie, int order)
    : lie_(lie), order_(order), tableau_(classical_runge_kutta4().tableau) {
  const M zero = lie.zero();
  start_ = end_ = {zero, zero, zero, zero};
  k_.assign(static_cast<std::size_t>(tableau_.stages()), zero);
  B_stage_ = W_stage_ = commutator_ = zero;
  if (order == 4) {
    a0_ = a1_ = zero;
  } else {
    middle_ = start_;
    m0_ = m1_ = m2_ = alpha1_ = alpha2_ = alpha3_ = C1_ = C2_ = left_ = right_ = zero;
  }
}

template <class Real>
void SplitMagnus<Real>::form_exponent(M& Omega, const M& W0, double h) {
  start_.W = 1.0 * W0;
  evaluate(start_);
  if (order_ == 4) {
    form_fourth(Omega, h);
  } else {
    form_fifth(Omega, h);
  }
}

// Sets B, k and D of a point from its W.
template <class Real>
void SplitMagnus<Real>::evaluate(Point& point) {
  lie_.cut(point.W);
  lie_.generate(point.B, point.W);
  lie_.bracket(point.k, point.B, point.W);
  lie_.generate(point.D, point.k);
}

// Sets W to that of the classical Runge-Kutta step of h from a point, which is evaluated.
template <class Real>
void SplitMagnus<Real>::predict(M& W, const Point& from, double h) {
  k_[0] = 1.0 * from.k;
  for (std::size_t i = 1; i < k_.size(); ++i) {
    W_stage_ = from.W + h * sum(tableau_.a.row(static_cast<Index>(i)), k_);
    lie_.cut(W_stage_);
    lie_.generate(B_stage_, W_stage_);
    lie_.bracket(k_[i], B_stage_, W_stage_);
  }
  W = from.W + h * sum(tableau_.b, k_);
}

// From the start, which is evaluated.
template <class Real>
void SplitMagnus<Real>::form_fourth(M& Omega, double h) {
  predict(end_.W, start_, h);
  evaluate(end_);
  const double a = h / 2.0;
  const double b = h * h / 12.0;
  a0_ = a * start_.B + a * end_.B + b * start_.D - b * end_.D;
  const double c = h / 10.0;
  const double d = h * h / 120.0;
  a1_ = c * end_.B - c * start_.B - d * start_.D - d * end_.D;
  lie_.bracket(commutator_, a0_, a1_);
  Omega = a0_ - commutator_;
}

template <class Real>
void SplitMagnus<Real>::form_fifth(M& Omega, double h) {
  predict(middle_.W, start_, 0.5 * h);
  evaluate(middle_);
  predict(end_.W, middle_, 0.5 * h);
  evaluate(end_);
  const M &b0 = start_.B, &bm = middle_.B, &b1 = end_.B;
  const M &D0 = start_.D, &Dm = middle_.D, &D1 = end_.D;

  double k = h / 60.0;
  m0_ = (14.0 * k) * b0 + (32.0 * k) * bm + (14.0 * k) * b1 + (h * k) * D0 - (h * k) * D1;
  k = h / 840.0;
  m1_ = (60.0 * k) * b1 - (60.0 * k) * b0 - (3.0 * h * k) * D0 + (16.0 * h * k) * Dm -
        (3.0 * h * k) * D1;
  k = h / 1680.0;
  m2_ =
      (54.0 * k) * b0 + (32.0 * k) * bm + (54.0 * k) * b1 + (3.0 * h * k) * D0 - (3.0 * h * k) * D1;
  alpha2_ = 12.0 * m1_;
  alpha3_ = 180.0 * m2_ - 15.0 * m0_;
  alpha1_ = m0_ - (1.0 / 12.0) * alpha3_;

  lie_.bracket(C1_, alpha1_, alpha2_);
  left_ = 2.0 * alpha3_ + C1_;
  lie_.bracket(C2_, alpha1_, left_, -1.0 / 60.0);
  left_ = C1_ - 20.0 * alpha1_ - alpha3_;
  right_ = alpha2_ + C2_;
  lie_.bracket(commutator_, left_, right_, 1.0 / 240.0);
  Omega = alpha1_ + (1.0 / 12.0) * alpha3_ + commutator_;
}

template class SplitMagnus<double>;
template class SplitMagnus<float>;

}  // namespace isosyrk
