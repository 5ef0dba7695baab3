// Quantised spherical harmonics T_lm: eigenvectors of the quantised Laplacian.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns T_lm of size n, m >= 0, as the n-m real entries on its diagonal (i, i+m).  They are the
/// unit eigenvector of -Δ there for the eigenvalue l(l+1), with first entry of sign (-1)^m.  They
/// equal sqrt(2l+1) (-1)^(j-m1) 3j(j l j; -m1 m m2).  T_{l,-m} = (-1)^m T_lm†.
/// Throws std::invalid_argument unless 0 <= m <= l < n.
RealVector harmonic(Index n, int l, int m);

}  // namespace isosyrk
