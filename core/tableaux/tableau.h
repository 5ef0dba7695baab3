// Runge-Kutta tableaux as pure data.
#pragma once

#include <string>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Largest number of stages of a tableau.  Up to here Gauss tableaux are accurate to the last
/// digit.
inline constexpr int max_stages = 20;

/// Coefficients a_ij, b_i, c_i of a Runge-Kutta method with s stages.
struct Tableau {
  std::string name;
  int order = 0;
  RealMatrix a;  ///< s x s
  RealVector b;  ///< s weights, summing to 1
  RealVector c;  ///< s nodes, c_i = sum_j a_ij

  int stages() const { return static_cast<int>(b.size()); }
};

/// Returns the largest |b_i a_ij + b_j a_ji - b_i b_j|, which is 0 up to rounding exactly for
/// symplectic tableaux.  For these the three formulations coincide (the paper's theorem).
double symplecticity_defect(const Tableau& tableau);

/// Throws std::invalid_argument unless the sizes agree, the tableau has 1 to max_stages stages and
/// every coefficient is finite.
void require_consistent(const Tableau& tableau);

}  // namespace isosyrk
