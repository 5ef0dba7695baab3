// The exponential of a skew-Hermitian matrix, and conjugation by it.
#pragma once

#include <utility>
#include <vector>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Computes W₁ = U W₀ U†, with U = e^Ω to a wanted error and unitary to rounding: the spectrum
/// stays whatever error is wanted.
///
/// e^Ω is its Taylor series, cut after the terms that ‖Ω‖ needs.  With the Hermitian X = Ω²
///
///     e^Ω = C(X) + Ω S(X),   C(X) = Σ_j X^j / (2j)!,   S(X) = Σ_j X^j / (2j+1)!,   j <= m
///
/// and both polynomials by Paterson and Stockmeyer's scheme in blocks of q: powers X ... X^q, then
/// Horner in X^q.  All powers and polynomials are Hermitian, ΩS and W₁ skew-Hermitian: a triangle
/// each.
///
/// To rounding, e^Ω is unitary as it is: what all cuts leave out changes it by a few 1e-18.  Where
/// a larger error is allowed and Ω has a band, fewer terms and narrower bands give some A near
/// e^(-Ω), and U† = A (A†A)^(-1/2) is its unitary factor.  With E = A†A - I, of a few 1e-9,
///
///     W₁ = V - (EV + VE) / 2,   V = A† W₀ A
///
/// but for terms in E², a few 1e-18.  Few digits of E matter: EV is formed in single precision.
///
/// Equivalent products: 4 to 6.5, from m = 4 to 21, and fewer where bands are cut.
/// Source: M. S. Paterson, L. J. Stockmeyer, SIAM J. Comput. 2, 1973.
class SplitExponential {
 public:
  /// The bands must outlive it.
  SplitExponential(Index n, BandTruncation& bands);

  /// W1 = U W0 U†, exactly skew-Hermitian, for skew-Hermitian Ω and W0, with ‖U - e^Ω‖_F of at most
  /// `error`, or to rounding.  Sets `adjoint` to the A of U†.  Returns false if ‖Ω⁴‖_F^{1/4}, from
  /// 1 to n^{1/8} times ‖Ω‖₂, is beyond the longest series, 6.7, or not finite; W1 is then
  /// unspecified.  Allocates nothing.
  bool conjugate(SplitMatrix& W1, SplitMatrix& adjoint, const SplitMatrix& Omega,
                 const SplitMatrix& W0, double error, SplitProducts& products,
                 SingleProducts& single_products);

  /// out = A† X A = U X U†, exactly skew-Hermitian, with the A of a conjugate() and a
  /// skew-Hermitian X.  Products: 1.5.
  void transport(SingleMatrix& out, const SplitMatrix& adjoint, const SingleMatrix& X,
                 SingleProducts& single_products);

 private:
  const SplitMatrix& power(int j) const { return powers_[static_cast<std::size_t>(j - 1)]; }
  void form_power(int j, const SplitMatrix& A, const SplitMatrix& B, SplitProducts& products);
  // Sets C(X) and S(X), of degree m, in blocks of q.  size is at least ‖X‖₂.
  void form_polynomials(int m, int q, double size, SplitProducts& products);
  bool form_adjoint(SplitMatrix& A, const SplitMatrix& Omega, SplitProducts& products);
  void make_unitary(SplitMatrix& W1, const SplitMatrix& A, SplitProducts& products,
                    SingleProducts& single_products);
  // Returns X cut to the band of a tail: X itself without bands, a copy otherwise.
  const SplitMatrix& cut_copy(SplitMatrix& copy, const SplitMatrix& X, double tail);

  BandTruncation& bands_;
  std::vector<SplitMatrix> powers_;  // X^1 ... X^7
  SplitMatrix cosine_;               // C(X)
  SplitMatrix sine_;                 // S(X)
  SplitMatrix cut_;                  // X^q or W₀, cut
  SplitMatrix Omega_sine_;           // Ω S(X)
  SplitMatrix scratch_;
  double left_out_ = 0.0;         // what each cut may change in e^Ω
  SingleMatrix defect_;           // E
  SingleMatrix V_, EV_, repair_;  // repair_ = -(EV + VE) / 2
  SingleMatrix adjoint_single_;   // A
};

}  // namespace isosyrk
