// What an isospectral Lie-Poisson flow conserves beside the spectrum.
#pragma once

#include <array>

#include "isosyrk/linalg/spectrum.h"

namespace isosyrk {

/// Angular momentum Im tr(S_a W), a = x, y, z, with S_a of spin (n-1)/2.
std::array<double, 3> angular_momentum(const Matrix& W);

}  // namespace isosyrk
