// What an isospectral Lie-Poisson flow conserves, and how far a computed W is from it.
#pragma once

#include <array>

#include "core/matrix.h"

namespace isosyrk {

/// Eigenvalues of -iW, ascending, for skew-Hermitian W (LAPACK zheevd on the Hermitian part of
/// -iW; how far W is from skew-Hermitian is skew_defect's to say).  Throws std::invalid_argument
/// for a W that is not square or not finite.
RealVector spectrum(const Matrix& W);

/// Largest |λ_k(W) - λ_k(V)| of the sorted spectra.
double spectrum_error(const Matrix& W, const Matrix& V);

/// Spectral norm of a skew-Hermitian W.
double spectral_norm(const Matrix& W);

/// Casimir tr(W^k), k >= 1.
Complex casimir(const Matrix& W, int k);

/// Largest entry of |W + W†|.
double skew_defect(const Matrix& W);

/// Angular momentum Im tr(S_a W), a = x, y, z, with S_a of spin (n-1)/2.
std::array<double, 3> angular_momentum(const Matrix& W);

}  // namespace isosyrk
