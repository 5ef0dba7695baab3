// Explicit Magnus methods as pure data.
#pragma once

#include <string>
#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// A Magnus method for Y' = B(t) Y over a step of h, with B_i = B(c_i h) and D_i = B'(c_i h).  From
/// the moments of B over the step, with p and q the terms of_B and of_D,
///
///     m_k = (h/over) (Σ_i p_i B_i + h Σ_i q_i D_i)  ≈  h ∫₀¹ (τ - ½)^k B(τh) dτ,
///
/// follow elements X of the algebra: m₀, m₁ ..., then sums of the X before, then brackets
/// scale [Σ left X, Σ right X] of the X before.  The exponent is Ω = Σ Omega X.
///
/// For W' = [B(W), W] a Runge-Kutta method gives W at the nodes, and W₁ = e^Ω W₀ e^(-Ω).
struct MagnusScheme {
  /// The number above / below times B_i, D_i or X_i with i = `of`.
  struct Term {
    std::size_t of;
    double above;
    double below = 1.0;
  };
  using Sum = std::vector<Term>;
  struct Moment {
    double over;
    Sum of_B;
    Sum of_D;
  };
  struct Bracket {
    Sum left;
    Sum right;
    double scale = 1.0;
  };

  std::string name;
  int order;         ///< of the method
  int order_of_sum;  ///< of e^Ω with exact moments
  RealVector nodes;  ///< c_i, from 0 to 1
  std::vector<Moment> moments;
  std::vector<Sum> sums;
  std::vector<Bracket> brackets;
  Sum Omega;
};

/// Returns the method of order 4 with the nodes 0 and 1:
///
///     m₀ = (h/2) (B₀ + B₁) + (h²/12) (D₀ - D₁)
///     m₁ = (h/10) (B₁ - B₀) - (h²/120) (D₀ + D₁)
///     Ω  = m₀ - [m₀, m₁]
///
/// The moments are those of the polynomial of degree 3 through B_i and D_i.
/// Source: Blanes, Casas and Ros, Improved high order integrators based on the Magnus expansion,
/// BIT 40 (2000), for Ω; Calvo, Iserles and Zanna 1997, Casas and Iserles 2006, for W' = [B(W), W].
const MagnusScheme& magnus4();

/// Returns the method of order 5 with the nodes 0, ½ (m) and 1, and with d_i = h D_i:
///
///     m₀ = (h/60)   (14 B₀ + 32 B_m + 14 B₁ + d₀ - d₁)
///     m₁ = (h/840)  (60 B₁ - 60 B₀ - 3 d₀ + 16 d_m - 3 d₁)
///     m₂ = (h/1680) (54 B₀ + 32 B_m + 54 B₁ + 3 d₀ - 3 d₁)
///     α₂ = 12 m₁,   α₃ = 180 m₂ - 15 m₀,   α₁ = m₀ - α₃/12
///     C₁ = [α₁, α₂],   C₂ = -[α₁, 2 α₃ + C₁]/60,   C₃ = [C₁ - 20 α₁ - α₃, α₂ + C₂]/240
///     Ω  = α₁ + α₃/12 + C₃
///
/// The moments are those of the polynomial of degree 5 through B_i and D_i.  e^Ω is of order 6; the
/// method is of order 5, since W at the nodes is given by Runge-Kutta steps of order 4.
/// Source: as magnus4().
const MagnusScheme& magnus5();

}  // namespace isosyrk
