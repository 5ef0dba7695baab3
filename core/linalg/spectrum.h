// Spectra of skew-Hermitian matrices, what follows from them, and the defect of skewness.
#pragma once

#include "isosyrk/linalg/matrix.h"

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

}  // namespace isosyrk
