// Gauss-Legendre collocation tableaux for any number of stages.
#pragma once

#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// The Gauss tableau with s stages, order 2s: nodes c_i the zeros of the Legendre polynomial
/// P_s(2x - 1), b_i the weights of that quadrature, a_ij = integral from 0 to c_i of the j-th
/// Lagrange polynomial.  Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3.
/// Throws std::invalid_argument unless 1 <= s <= max_stages.
Tableau gauss_tableau(int s);

}  // namespace isosyrk
