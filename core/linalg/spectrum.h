// Spectra, norms and Casimirs.
#pragma once

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/linalg/quadratic_algebra.h"

namespace isosyrk {

/// Returns the eigenvalues of the Hermitian part of -iW, ascending (LAPACK zheevd).  For
/// skew-Hermitian W these are the eigenvalues of -iW; skew_defect() measures the distance.  Throws
/// std::invalid_argument unless W is square and finite, std::runtime_error if zheevd fails.
RealVector spectrum(const Matrix& W);

/// Returns the largest |λ_k(W) - λ_k(V)| of the sorted spectra.  Throws as spectrum().
double spectrum_error(const Matrix& W, const Matrix& V);

/// Returns the distance of the spectra of two n x n matrices of an algebra.  For J = I this is
/// spectrum_error(), computed for each diagonal block.  Otherwise, it is the largest distance of
/// eigenvalues that are paired, each eigenvalue of V with the nearest one of W that is left.
/// Throws as spectrum().
double spectrum_error(const QuadraticAlgebra& algebra, const Matrix& W, const Matrix& V);

/// Returns the spectral norm of a skew-Hermitian W.  Throws as spectrum().
double spectral_norm(const Matrix& W);
/// Returns the spectral norm of any square matrix.  Throws as spectrum().
double operator_norm(const Matrix& B);

/// Returns the Casimir tr(W^k), by k - 1 products.  It overflows for norms beyond about 1e(308/k);
/// casimir_errors() does not.  Throws std::invalid_argument for k < 1.
Complex casimir(const Matrix& W, int k);

/// Returns the largest entry of |W + W†|.
double skew_defect(const Matrix& W);

}  // namespace isosyrk
