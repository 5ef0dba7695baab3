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
