// The modified Hamiltonian F of the exponential Lie-Poisson methods, and its gradient.
//
// For a flow W' = [B(W), W] with J = I and B = ∇H, linear and self-adjoint in <a, b> = -tr(ab), so
// that H(W) = ½ <W, BW>.  With
//
//     v = Bμ,   f = [v, μ],   v₁ = Bf,   p = [v, f],   c = [v₁, μ],   w = [v, v₁]
//
// F = H + h² F₂ + h⁴ F₄, cut after the term of the wanted order, where
//
//     F₂ = <f, Bf> / 24,   F₄ = (<p, Bp> + 2 <p, Bc> + 6 <c, Bc> + 2 <p, w> + 6 <c, w>) / 1440.
//
// core/integrators/EXPONENTIAL.md derives both.
#pragma once

#include "isosyrk/integrators/lie_operations.h"

namespace isosyrk {

/// Coefficients of F₂ and F₄, named by their terms.  A test derives them
/// (tests/scripts/derive_modified_hamiltonian.py) and reads them here.
namespace modified_hamiltonian {
inline constexpr double f_Bf = 1.0 / 24.0;
inline constexpr double p_Bp = 1.0 / 1440.0;
inline constexpr double p_Bc = 2.0 / 1440.0;
inline constexpr double c_Bc = 6.0 / 1440.0;
inline constexpr double p_w = 2.0 / 1440.0;
inline constexpr double c_w = 6.0 / 1440.0;
}  // namespace modified_hamiltonian

/// The terms of the gradient B̃ = ∇F = v + h² ∇F₂ + h⁴ ∇F₄ beyond v, differentiated backwards: x̄ is
/// the derivative of F by x where x is any of the matrices above.  With k = h⁴:
///
///     p̄ = k (B(2 p_Bp p + p_Bc c) + p_w w)
///     c̄ = k (B(p_Bc p + 2 c_Bc c) + c_w w)
///     w̄ = k (p_w p + c_w c)
///     v̄₁ = [μ, c̄] + [w̄, v]
///     f̄ = 2 h² f_Bf v₁ + [p̄, v] + B v̄₁
///     v̄ = [f, p̄] + [v₁, w̄] + [μ, f̄]
///     B̃ - v = [c̄, v₁] + [f̄, v] + B v̄
///
/// h² ∇F₂ alone has only the first term of f̄, the last of v̄ and no [c̄, v₁]; h⁴ ∇F₄ alone has not
/// the first term of f̄.  Brackets: 3 for h², 12 for both, 11 for h⁴ alone.  Evaluations of B: 2, 5,
/// 5.
///
/// Written once for published and fast forms.  The derivative of h² ∇F₂ is used by the Jacobian of
/// the fast form.
template <LieOperations Lie>
class ModifiedGradient {
 public:
  using M = typename Lie::M;

  /// Which terms are formed.
  struct Terms {
    bool second;  ///< h² ∇F₂
    bool fourth;  ///< h⁴ ∇F₄
  };

  /// Makes workspace for the terms of a method of this order: 2, 4 or 6.  The operations must
  /// outlive it.
  ModifiedGradient(Lie& lie, int order);

  /// out = the sum of the chosen terms, from μ and v = B(μ).  Allocates nothing.
  void evaluate(M& out, const M& mu, const M& v, double h, Terms terms);

  /// Sets what derivative_of_second() needs, from μ and v = B(μ).  Brackets: 1.  Evaluations of
  /// B: 1.
  void linearize(const M& mu, const M& v);
  /// out = h² (∇F₂)'(μ) D, with BD = B(D).  Brackets: 6.  Evaluations of B: 2.  Only after
  /// evaluate() or linearize() with this μ and v.
  void derivative_of_second(M& out, const M& mu, const M& v, const M& D, const M& BD, double h);

 private:
  void add_fourth(const M& mu, const M& v, double h);

  Lie& lie_;
  M f_, v1_;
  M f_bar_;
  M v_bar_;   // also v̄₁, before
  M mu_bar_;  // of the brackets: B̃ - v - B v̄
  M term_;
  // Of h⁴; empty otherwise.
  M p_, c_, w_;
  M p_bar_, c_bar_, w_bar_;
};

template <LieOperations Lie>
ModifiedGradient<Lie>::ModifiedGradient(Lie& lie, int order) : lie_(lie) {
  if (order >= 4) f_ = v1_ = f_bar_ = v_bar_ = mu_bar_ = term_ = lie.zero();
  if (order >= 6) p_ = c_ = w_ = p_bar_ = c_bar_ = w_bar_ = lie.zero();
}

template <LieOperations Lie>
void ModifiedGradient<Lie>::evaluate(M& out, const M& mu, const M& v, double h, Terms terms) {
  namespace of = modified_hamiltonian;
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

template <LieOperations Lie>
void ModifiedGradient<Lie>::linearize(const M& mu, const M& v) {
  lie_.bracket(f_, v, mu);
  lie_.generate(v1_, f_);
}

// Adds the derivative of F₄ to f̄, and sets v̄ and μ̄ to what it contributes.
template <LieOperations Lie>
void ModifiedGradient<Lie>::add_fourth(const M& mu, const M& v, double h) {
  namespace of = modified_hamiltonian;
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

// ∇F₂ = k ([v₁, v] + B [μ, v₁]), k = 2 f_Bf: each factor in turn is replaced by its derivative, df
// = [BD, μ] + [v, D] and dv₁ = B df for f and v₁.
template <LieOperations Lie>
void ModifiedGradient<Lie>::derivative_of_second(M& out, const M& mu, const M& v, const M& D,
                                                 const M& BD, double h) {
  const double k = 2.0 * h * h * modified_hamiltonian::f_Bf;
  M& df = f_bar_;  // these two are free until the next evaluate()
  M& dv1 = v_bar_;
  lie_.cut(v1_);
  lie_.bracket(df, BD, mu);
  lie_.add_bracket(df, v, D);
  lie_.generate(dv1, df);
  lie_.bracket(term_, mu, dv1, k);
  lie_.add_bracket(term_, D, v1_, k);
  lie_.generate(out, term_);
  lie_.add_bracket(out, dv1, v, k);
  lie_.add_bracket(out, v1_, BD, k);
}

}  // namespace isosyrk
