// Conserved quantities of the Euler-Zeitlin equations beside the spectrum and the energy.
#pragma once

#include <array>

#include "isosyrk/linalg/spectrum.h"

namespace isosyrk {

/// Returns the angular momentum Im tr(S_a W), a = x, y, z, with S_a of spin (n-1)/2.  W is n x n.
std::array<double, 3> angular_momentum(const Matrix& W);

}  // namespace isosyrk
