// Quantised spherical harmonics T_lm and vorticity matrices made of them.
#pragma once

#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// One coefficient ω_lm of the initial vorticity; real where m = 0.
struct Mode {
  int l;
  int m;
  Complex value;
};

/// The default initial data, l <= 4: tests/data/initial_modes.csv, compiled in.  The paper says
/// only "the modes l <= 4, same values for each n"; these values fix it.  They need n >= 5.
const std::vector<Mode>& default_modes();

/// Rough initial data: every l from 1 to n-1, energy falling as l^-3 on average, so that vorticity
/// is spread over all scales.  ω_lm is normal with E|ω_lm|² = (l+1) / (l² (2l+1)); drawn in the
/// order of l, then m, from one seed, so that the values with l < n are the same for every n.
/// Throws std::invalid_argument for n < 2.
std::vector<Mode> rough_modes(Index n);

/// Throws std::invalid_argument, naming the mode, unless every mode has 1 <= l < n and
/// 0 <= m <= l, is finite and real where m = 0, no (l, m) comes twice, and not all are zero.
void require_valid(const std::vector<Mode>& modes, Index n);

/// T_lm of size n, m >= 0, as the n-m real entries on its diagonal (i, i+m): the eigenvector of
/// -Δ there for the eigenvalue l(l+1), of unit norm, its first entry of the sign of (-1)^m.  This
/// equals sqrt(2l+1) (-1)^(j-m1) 3j(j l j; -m1 m m2).  T_{l,-m} = (-1)^m T_lm†.
/// Throws std::invalid_argument unless 0 <= m <= l < n.
RealVector harmonic(Index n, int l, int m);

/// W ∝ i Σ_l [ ω_l0 T_l0 + Σ_{m>0} (ω_lm T_lm + conj(ω_lm) T_lm†) ], exactly skew-Hermitian, scaled
/// to spectral norm 1.  Throws as require_valid does.
Matrix vorticity_from_modes(const std::vector<Mode>& modes, Index n);

}  // namespace isosyrk
