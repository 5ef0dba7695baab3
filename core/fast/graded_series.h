// Series of nested commutators in split-complex storage, each term in the precision that it needs.
#pragma once

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/term_growth.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// The terms of e^Ω W e^(-Ω) = Σ_k T_k for skew-Hermitian Ω and W,
///
///     T₀ = W,    T_k = [Ω, T_{k-1}] / k,
///
/// from which also φ₁(ad_Ω) W = Σ_k T_k / (k+1) and e^{s ad_Ω} W = Σ_k s^k T_k follow.  Each term
/// takes one product: [Ω, T] = M - M† with M = Ω T.  It is formed in single precision where the
/// rounding of that is below the wanted error, and added to sums in double precision.  No term is
/// formed that is expected to be negligible.
///
/// Usage: begin(); then, until advance() says that T_k is the last, add_upper_to() the sums; then
/// mirror_skew_in_band() of each.
class GradedSeries {
 public:
  /// For n x n matrices.  Products must outlive it.  Only the constructor allocates.  Without
  /// options.graded_series terms are formed down to rounding, whatever error is wanted.
  GradedSeries(SplitProducts& products, SingleProducts& single_products, Index n,
               const FastOptions& options = {});

  /// Wanted error of a sum that conjugates to rounding, as a multiple of ‖W‖.  Ten times this value
  /// shows in the spectrum of long runs.
  static constexpr double conjugation_error = 6e-17;

  /// The sum that has the wanted error.
  enum class Sum {
    conjugate,  ///< e^Ω W e^(-Ω) = Σ_k T_k
    average     ///< φ₁(ad_Ω) W = Σ_k T_k / (k+1)
  };
  /// Begins with T₀ = W.  In the sum, the terms left out and the rounding of single precision have
  /// about the Frobenius norm `error` each.
  void begin(const SplitMatrix& Omega, const SplitMatrix& W, double error, Sum sum);
  /// Forms the next term.  Returns false if it is the last, or if the series has failed.
  bool advance();
  /// True if a term was not finite, or 200 did not suffice.
  bool failed() const { return failed_; }
  /// Returns the number k of the present term.
  int k() const { return k_; }

  /// Returns ‖T_k‖_F of the present term.
  double size() const { return size_; }

  /// Adds T_k to sums, in the upper triangles and unspecified entries below.  At most three others.
  void add_upper_to(Addition<double> first, std::span<const Addition<float>> others = {}) const;

  /// Sets the norm that may be cut from each T_k.  Called before begin().
  void truncate(BandTruncation& bands, double tail) {
    bands_ = &bands;
    tail_ = tail;
  }

  /// out = e^Ω W e^(-Ω) with this error.  Returns false if the series fails.  out is not W.
  bool conjugate(SplitMatrix& out, const SplitMatrix& Omega, const SplitMatrix& W, double error);

 private:
  double weight(int k) const;
  bool is_last() const;
  template <class Real>
  void cut_Omega(SplitMatrixOf<Real>& Omega);
  template <class Real>
  double cut(SplitMatrixOf<Real>& term);

  SplitProducts& products_;
  SingleProducts& single_products_;
  bool is_graded_;
  BandTruncation* bands_ = nullptr;
  double tail_ = 0.0;
  double error_ = 0.0;
  double tail_now_ = 0.0;  // norm that may be cut from each T_k of this series
  Sum sum_ = Sum::conjugate;
  double end_ = 0.0;  // norm of a negligible part of the sum
  int k_ = 0;
  double size_ = 0.0;  // ‖T_k‖_F
  TermGrowth growth_;
  bool in_single_ = false;
  bool failed_ = false;
  SplitMatrix Omega_;    // cut to what the next term needs
  SplitMatrix term_;     // T_k where it is in double precision
  SplitMatrix next_;     // T_{k+1}
  SplitMatrix product_;  // Ω T_k
  SingleMatrix Omega_single_;
  SingleMatrix term_single_;  // T_k where it is in single precision
  SingleMatrix next_single_, product_single_;
  RealVector squares_of_Omega_;  // over its diagonals
};

}  // namespace isosyrk
