// Explicit methods as pure data.
#pragma once

#include <vector>

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// An explicit Runge-Kutta method with a limit of linear stability.
struct ExplicitScheme {
  Tableau tableau;
  /// Largest y with |R(iz)| <= 1 for 0 <= z <= y, R the stability function.  A constant generator
  /// gives W' = ad_B W, and ad_B has imaginary eigenvalues.
  double imaginary_limit;
};

/// Returns the classical Runge-Kutta method, order 4, 4 stages, imaginary limit 2√2.
/// Source: Kutta 1901; Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, table
/// II.1.2.
const ExplicitScheme& classical_runge_kutta4();

/// Returns the method of order 5 of the pair 5(4) of Dormand and Prince, with 6 stages, imaginary
/// limit 0.997.  At a fixed step its seventh stage is the first one of the next step.
/// Source: Dormand and Prince 1980; Hairer, Nørsett, Wanner, table II.5.2.
const ExplicitScheme& dormand_prince5();

/// Returns DOP853's method of order 8, with 12 stages, imaginary limit 5.96.
/// Source: Hairer, Nørsett, Wanner, section II.5; coefficients of their program DOP853.
const ExplicitScheme& dormand_prince8();

/// Returns Feagin's method of order 10, with 17 stages, imaginary limit 1.15.
/// Source: Feagin, A tenth-order Runge-Kutta method with error estimate, 2007; coefficients of its
/// file rk108.
const ExplicitScheme& feagin10();

/// Returns R(z) = 1 + z b† (I - zA)⁻¹ 1 of an explicit method, at z = iy.
Complex stability_function(const Tableau& tableau, double y);

/// Throws std::invalid_argument unless a tableau is consistent and a_ij = 0 for j >= i.
void require_explicit(const Tableau& tableau);

/// A Runge-Kutta method of Munthe-Kaas: exponents Ω_i in the algebra, with k_i = h B(Ad(Ω_i) W₀),
///
///     Ω_i = Σ_j a_ij k_j + Σ weight [k_left, k_right]
///     Ω   = Σ_j b_j k_j  + Σ weight [k_left, k_right]
///
/// where the second sums go over the commutators of that exponent.
struct MuntheKaasScheme {
  /// A commutator in the exponent of a stage, counted from 0; stage s is Ω itself.
  struct Commutator {
    std::size_t stage;
    std::size_t left;
    std::size_t right;
    double weight;
  };
  Tableau tableau;
  std::vector<Commutator> commutators;  ///< at most one for each exponent
};

/// Returns the method of order 4 with 4 stages and two commutators.
/// Source: Munthe-Kaas 1999; Casas and Owren 2003.
MuntheKaasScheme munthe_kaas4();

}  // namespace isosyrk
