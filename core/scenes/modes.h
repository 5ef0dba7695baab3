// Initial data by their modes: coefficients of quantised spherical harmonics (flows/harmonic.h).
#pragma once

#include <string>
#include <vector>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// One coefficient ω_lm of the initial vorticity, real if m = 0.
struct Mode {
  int l;
  int m;
  Complex value;
};

/// Returns the default initial data: modes l <= 4, for n >= 5.  Equal to
/// tests/data/initial_modes.csv.  The paper says only "the modes l <= 4, same values for each n".
const std::vector<Mode>& default_modes();

/// Returns rough initial data: every l from 1 to n-1, with energy falling as l^-3 on average, so
/// that vorticity is spread over all scales.  ω_lm is normal with E|ω_lm|² = (l+1) / (l² (2l+1)).
/// The numbers are drawn in the order of l, then m, from one seed: mode (l, m) is the same for
/// every n.
/// Throws std::invalid_argument for n < 2.
std::vector<Mode> rough_modes(Index n);

/// Throws std::invalid_argument, naming the mode, unless 1 <= l < n and 0 <= m <= l and the value
/// is finite, and real if m = 0.
void require_valid_mode(const Mode& mode, Index n);

/// Throws std::invalid_argument unless every mode is valid, each (l, m) comes once and one value at
/// least is not 0.  The message names the mode.
void require_valid(const std::vector<Mode>& modes, Index n);

/// Returns W ∝ i Σ_l [ ω_l0 T_l0 + Σ_{m>0} (ω_lm T_lm + conj(ω_lm) T_lm†) ], n x n, exactly
/// skew-Hermitian, scaled to spectral norm 1.  Throws as require_valid.
Matrix vorticity_from_modes(const std::vector<Mode>& modes, Index n);

/// Returns a hash of the modes (FNV-1a, 64 bits, of the lines "l,m,re,im" in the order given), as
/// 16 hex digits: tells whether two results started from the same data.
std::string hash_of(const std::vector<Mode>& modes);

}  // namespace isosyrk
