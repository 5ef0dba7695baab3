#include "isosyrk/catalogue/family.h"

namespace isosyrk {

std::string_view name(Family family) {
  switch (family) {
    case Family::gauss:
      return "Gauss";
    case Family::direct_gauss:
      return "direct Gauss";
    case Family::composition:
      return "composition";
    case Family::munthe_kaas:
      return "RKMK";
    case Family::exponential_lie_poisson:
      return "exponential Lie–Poisson";
    case Family::bogfjellmo_marthinsen:
      return "Bogfjellmo–Marthinsen";
    case Family::crouch_grossman:
      return "Crouch–Grossman";
    case Family::explicit_magnus:
      return "explicit Magnus";
    case Family::runge_kutta:
      return "Runge–Kutta";
    case Family::adams_bashforth_moulton:
      return "Adams–Bashforth–Moulton";
    case Family::other:
      break;
  }
  return "other";
}

}  // namespace isosyrk
