// Gauss-Legendre collocation tableaux for any number of stages.
#pragma once

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// Returns the Gauss tableau with s stages, order 2s.  The nodes c_i are the zeros of the Legendre
/// polynomial P_s(2x - 1) and b_i the weights of the Gauss quadrature on them.  a_ij is the
/// integral from 0 to c_i of the j-th Lagrange polynomial.
/// Throws std::invalid_argument unless 1 <= s <= max_stages.
/// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3.
Tableau gauss_tableau(int s);

}  // namespace isosyrk
