#include "isosyrk/integrators/modified_gradient.h"

namespace isosyrk {

namespace of = modified_hamiltonian;  // its coefficients

template <class Scalar>
ModifiedGradient<Scalar>::ModifiedGradient(int order, const QuadraticAlgebra& algebra,
                                           LieOperations<Scalar> lie)
    : order_(order), lie_(std::move(lie)) {
  v_ = algebra.zero<Scalar>();
  if (order >= 4) f_ = v1_ = f_bar_ = v_bar_ = mu_bar_ = term_ = v_;
  if (order >= 6) p_ = c_ = w_ = p_bar_ = c_bar_ = w_bar_ = v_;
}

template <class Scalar>
void ModifiedGradient<Scalar>::add_bracket(const Stored& A, const Stored& B, Stored& sum) {
  lie_.bracket(A, B, term_);
  sum += term_;
}

template <class Scalar>
void ModifiedGradient<Scalar>::evaluate(const Stored& mu, double h, Stored& out) {
  lie_.generator(mu, v_);
  out = v_;
  if (order_ == 2) return;
  lie_.bracket(v_, mu, f_);
  lie_.generator(f_, v1_);
  f_bar_ = (2.0 * h * h * of::f_Bf) * v1_;
  v_bar_.setZero();
  mu_bar_.setZero();
  if (order_ == 6) add_fourth_power(mu, h);
  add_bracket(mu, f_bar_, v_bar_);
  add_bracket(f_bar_, v_, mu_bar_);
  lie_.generator(v_bar_, term_);
  out += mu_bar_ + term_;
}

// Adds what the derivatives of F₄ contribute to f̄, v̄ and μ̄.
template <class Scalar>
void ModifiedGradient<Scalar>::add_fourth_power(const Stored& mu, double h) {
  const double k = h * h * h * h;
  lie_.bracket(v_, f_, p_);
  lie_.bracket(v1_, mu, c_);
  lie_.bracket(v_, v1_, w_);

  term_ = (2.0 * k * of::p_Bp) * p_ + (k * of::p_Bc) * c_;
  lie_.generator(term_, p_bar_);
  p_bar_ += (k * of::p_w) * w_;
  term_ = (k * of::p_Bc) * p_ + (2.0 * k * of::c_Bc) * c_;
  lie_.generator(term_, c_bar_);
  c_bar_ += (k * of::c_w) * w_;
  w_bar_ = (k * of::p_w) * p_ + (k * of::c_w) * c_;

  Stored& v1_bar = v_bar_;
  lie_.bracket(mu, c_bar_, v1_bar);
  add_bracket(w_bar_, v_, v1_bar);
  lie_.generator(v1_bar, term_);
  f_bar_ += term_;
  add_bracket(p_bar_, v_, f_bar_);

  lie_.bracket(f_, p_bar_, v_bar_);
  add_bracket(v1_, w_bar_, v_bar_);
  lie_.bracket(c_bar_, v1_, mu_bar_);
}

template class ModifiedGradient<double>;
template class ModifiedGradient<Complex>;

}  // namespace isosyrk
