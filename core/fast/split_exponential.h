// The exponential of a skew-Hermitian matrix, and conjugation by it.
#pragma once

#include <vector>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Computes W₁ = e^Ω W₀ e^(-Ω) to rounding by the Taylor series of e^Ω, cut after the terms that
/// ‖Ω‖ needs.  With the Hermitian X = Ω²
///
///     e^Ω = C(X) + Ω S(X),   C(X) = Σ_j X^j / (2j)!,   S(X) = Σ_j X^j / (2j+1)!,   j <= m
///
/// and both polynomials by Paterson and Stockmeyer's scheme in blocks of q: powers X ... X^q, then
/// Horner in X^q.  All powers and polynomials are Hermitian, ΩS and W₁ skew-Hermitian: a triangle
/// each.  Equivalent products: 4 to 6.5, from m = 4 to 21, and fewer where bands are cut: what all
/// cuts leave out changes e^Ω by a few 1e-18.
/// Source: M. S. Paterson, L. J. Stockmeyer, SIAM J. Comput. 2, 1973.
class SplitExponential {
 public:
  /// The bands must outlive it.
  SplitExponential(Index n, BandTruncation& bands);

  /// W1 = e^Ω W0 e^(-Ω), exactly skew-Hermitian, for skew-Hermitian Ω and W0.  Returns false if
  /// ‖Ω⁴‖_F^{1/4}, from 1 to n^{1/8} times ‖Ω‖₂, is beyond the longest series, 6.7, or not finite;
  /// W1 is then unspecified.  Allocates nothing.
  bool conjugate(SplitMatrix& W1, const SplitMatrix& Omega, const SplitMatrix& W0,
                 SplitProducts& products);

 private:
  const SplitMatrix& power(int j) const { return powers_[static_cast<std::size_t>(j - 1)]; }
  void form_power(int j, const SplitMatrix& A, const SplitMatrix& B, SplitProducts& products);
  // Sets C(X) and S(X), of degree m, in blocks of q.  size is at least ‖X‖₂.
  void form_polynomials(int m, int q, double size, SplitProducts& products);
  // Returns X cut to the band of a tail: X itself without bands, a copy otherwise.
  const SplitMatrix& cut_copy(SplitMatrix& copy, const SplitMatrix& X, double tail);

  BandTruncation& bands_;
  std::vector<SplitMatrix> powers_;  // X^1 ... X^7
  SplitMatrix cosine_;               // C(X)
  SplitMatrix sine_;                 // S(X)
  SplitMatrix cut_;                  // X^q or W₀, cut
  SplitMatrix Omega_sine_;           // Ω S(X)
  SplitMatrix adjoint_;              // e^(-Ω) = C - ΩS
  SplitMatrix scratch_;
};

}  // namespace isosyrk
