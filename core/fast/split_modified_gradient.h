// The gradient of the modified Hamiltonian of exponential Lie-Poisson methods, in split-complex
// storage.
#pragma once

#include "isosyrk/fast/split_lie.h"

namespace isosyrk {

/// The terms of B̃(μ) = B(μ) + h² ∇F₂(μ) + h⁴ ∇F₄(μ) beyond the first, in one precision, with the
/// equations of ModifiedGradient (integrators/modified_gradient.h):
///
///     v = Bμ,   f = [v, μ],   v₁ = Bf,   p = [v, f],   c = [v₁, μ],   w = [v, v₁]
///     B̃ - v = [c̄, v₁] + [f̄, v] + B([f, p̄] + [v₁, w̄] + [μ, f̄])
///
/// Products: 3 for h² alone, 12 for both, 11 for h⁴ alone.  Poisson solves: 2, 5, 5.
template <class Real>
class SplitModifiedGradient {
 public:
  using M = SplitMatrixOf<Real>;

  /// Which terms are formed.
  struct Terms {
    bool second;  ///< h² ∇F₂
    bool fourth;  ///< h⁴ ∇F₄
  };

  explicit SplitModifiedGradient(SplitLie<Real>& lie, bool has_fourth);

  /// out = the sum of the chosen terms, from μ and v = B(μ).  Allocates nothing.
  void evaluate(M& out, const M& mu, const M& v, double h, Terms terms);

  /// Sets what derivative_of_second() needs, from μ and v = B(μ).  Products: 1.  Poisson solves: 1.
  void linearize(const M& mu, const M& v);
  /// out = h² (∇F₂)'(μ) D, with BD = B(D).  Products: 6.  Poisson solves: 2.  Only after
  /// evaluate() or linearize() with this μ and v.
  void derivative_of_second(M& out, const M& mu, const M& v, const M& D, const M& BD, double h);

 private:
  void add_fourth(const M& mu, const M& v, double h);

  SplitLie<Real>& lie_;
  M f_, v1_;
  M f_bar_;  // derivatives of F by f, v and μ
  M v_bar_;  // also that by v₁, before
  M mu_bar_;
  M term_;
  M df_, dv1_;  // derivatives of f and v₁
  // Of h⁴; empty otherwise.
  M p_, c_, w_;
  M p_bar_, c_bar_, w_bar_;
};

}  // namespace isosyrk
