// Families of methods: what an integrator is, whatever its order, formulation or frame.
#pragma once

#include <string_view>

namespace isosyrk {

/// Family of an integrator.  Its members differ in stages and order, formulation, projection and
/// frame.
enum class Family {
  gauss,                    ///< Gauss methods in a formulation of the paper
  direct_gauss,             ///< Gauss methods applied to W
  composition,              ///< compositions of the isospectral midpoint
  munthe_kaas,              ///< explicit Runge-Kutta-Munthe-Kaas methods
  exponential_lie_poisson,  ///< those of integrators/EXPONENTIAL.md
  bogfjellmo_marthinsen,    ///< theirs of Munthe-Kaas type
  crouch_grossman,          ///< theirs of Crouch-Grossman type
  explicit_magnus,          ///< explicit Magnus methods
  runge_kutta,              ///< explicit Runge-Kutta methods applied to W
  adams_bashforth_moulton,  ///< multistep methods applied to W
  other,                    ///< any other, which is a family of its own
};

/// Returns the name of a family, "Gauss" or "explicit Magnus".
std::string_view name(Family family);

}  // namespace isosyrk
