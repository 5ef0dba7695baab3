#include "isosyrk/fast/split_modified_gradient.h"

#include "isosyrk/integrators/modified_gradient.h"

namespace isosyrk {

namespace of = modified_hamiltonian;  // its coefficients

template <class Real>
SplitModifiedGradient<Real>::SplitModifiedGradient(SplitLie<Real>& lie, bool has_fourth)
    : lie_(lie),
      f_(lie.zero()),
      v1_(f_),
      f_bar_(f_),
      v_bar_(f_),
      mu_bar_(f_),
      term_(f_),
      df_(f_),
      dv1_(f_) {
  if (has_fourth) p_ = c_ = w_ = p_bar_ = c_bar_ = w_bar_ = f_;
}

template <class Real>
void SplitModifiedGradient<Real>::evaluate(M& out, const M& mu, const M& v, double h, Terms terms) {
  linearize(mu, v);
  f_bar_ = (terms.second ? 2.0 * h * h * of::f_Bf : 0.0) * v1_;
  if (terms.fourth) {
    add_fourth(mu, v, h);
    lie_.add_bracket(v_bar_, mu, f_bar_);
    lie_.add_bracket(mu_bar_, f_bar_, v);
  } else {
    lie_.bracket(v_bar_, mu, f_bar_);
    lie_.bracket(mu_bar_, f_bar_, v);
  }
  lie_.generate(term_, v_bar_);
  out = mu_bar_ + term_;
}

template <class Real>
void SplitModifiedGradient<Real>::linearize(const M& mu, const M& v) {
  lie_.bracket(f_, v, mu);
  lie_.generate(v1_, f_);
}

// ∇F₂ = k ([v₁, v] + B [μ, v₁]), k = 2 f_Bf: each factor in turn is replaced by its derivative.
template <class Real>
void SplitModifiedGradient<Real>::derivative_of_second(M& out, const M& mu, const M& v, const M& D,
                                                       const M& BD, double h) {
  const double k = 2.0 * h * h * of::f_Bf;
  lie_.cut(v1_);
  lie_.bracket(df_, BD, mu);
  lie_.add_bracket(df_, v, D);
  lie_.generate(dv1_, df_);
  lie_.bracket(term_, mu, dv1_, k);
  lie_.add_bracket(term_, D, v1_, k);
  lie_.generate(out, term_);
  lie_.add_bracket(out, dv1_, v, k);
  lie_.add_bracket(out, v1_, BD, k);
}

// Adds the derivative of F₄ to f̄, and sets v̄ and μ̄ to what it contributes.
template <class Real>
void SplitModifiedGradient<Real>::add_fourth(const M& mu, const M& v, double h) {
  const double k = h * h * h * h;
  lie_.bracket(p_, v, f_);
  lie_.bracket(c_, v1_, mu);
  lie_.bracket(w_, v, v1_);

  term_ = (2.0 * k * of::p_Bp) * p_ + (k * of::p_Bc) * c_;
  lie_.generate(p_bar_, term_);
  p_bar_ = p_bar_ + (k * of::p_w) * w_;
  term_ = (k * of::p_Bc) * p_ + (2.0 * k * of::c_Bc) * c_;
  lie_.generate(c_bar_, term_);
  c_bar_ = c_bar_ + (k * of::c_w) * w_;
  w_bar_ = (k * of::p_w) * p_ + (k * of::c_w) * c_;

  M& v1_bar = v_bar_;
  lie_.bracket(v1_bar, mu, c_bar_);
  lie_.add_bracket(v1_bar, w_bar_, v);
  lie_.generate(term_, v1_bar);
  f_bar_ = f_bar_ + term_;
  lie_.add_bracket(f_bar_, p_bar_, v);

  lie_.bracket(v_bar_, f_, p_bar_);
  lie_.add_bracket(v_bar_, v1_, w_bar_);
  lie_.bracket(mu_bar_, c_bar_, v1_);
}

template class SplitModifiedGradient<double>;
template class SplitModifiedGradient<float>;

}  // namespace isosyrk
