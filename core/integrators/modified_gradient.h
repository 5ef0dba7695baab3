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

#include <functional>

#include "isosyrk/linalg/quadratic_algebra.h"

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

/// B and the bracket of a flow, as functions of matrices in storage that set their last argument.
template <class Scalar>
struct LieOperations {
  using Stored = MatrixOf<Scalar>;
  std::function<void(const Stored& W, Stored& B)> generator;
  std::function<void(const Stored& A, const Stored& B, Stored& bracket)> bracket;
};

/// The gradient B̃ = ∇F, differentiated backwards: x̄ is the derivative of F by x where x is any of
/// the matrices above.  With k = h⁴:
///
///     p̄ = k (B(2 p_Bp p + p_Bc c) + p_w w)
///     c̄ = k (B(p_Bc p + 2 c_Bc c) + c_w w)
///     w̄ = k (p_w p + c_w c)
///     v̄₁ = [μ, c̄] + [w̄, v]
///     f̄ = 2 h² f_Bf v₁ + [p̄, v] + B v̄₁
///     v̄ = [f, p̄] + [v₁, w̄] + [μ, f̄]
///     B̃ = v + [c̄, v₁] + [f̄, v] + B v̄
///
/// Order 4 has only the first term of f̄, the last of v̄ and no [c̄, v₁]; order 2 has B̃ = v.
/// Brackets: 0, 3, 12 for order 2, 4, 6.  Evaluations of B: 1, 3, 6.
template <class Scalar>
class ModifiedGradient {
 public:
  using Stored = MatrixOf<Scalar>;

  /// order is 2, 4 or 6.
  ModifiedGradient(int order, const QuadraticAlgebra& algebra, LieOperations<Scalar> lie);

  /// out = B̃(μ) for steps of h.  Allocates nothing.  out is not μ.
  void evaluate(const Stored& mu, double h, Stored& out);

 private:
  void add_fourth_power(const Stored& mu, double h);
  void add_bracket(const Stored& A, const Stored& B, Stored& sum);

  int order_;
  LieOperations<Scalar> lie_;
  Stored v_, f_, v1_;
  Stored f_bar_;
  Stored v_bar_;   // also v̄₁, before
  Stored mu_bar_;  // of the brackets: B̃ - v - B v̄
  Stored term_;
  // Of order 6; empty otherwise.
  Stored p_, c_, w_;
  Stored p_bar_, c_bar_, w_bar_;
};

}  // namespace isosyrk
