// Conjugation by an exponential in split-complex storage, summed as a series of commutators.
#pragma once

#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Computes e^Ω W e^(-Ω) = Σ_k T_k for skew-Hermitian Ω and W, without forming the exponential:
///
///     T₀ = W,    T_k = [Ω, T_{k-1}] / k
///
/// Each term takes one product: [Ω, T] = M - M† with M = Ω T.  Terms below Tuning::single_term are
/// formed in single precision and added in double.  Only the constructor allocates.
class SplitAdjointSeries {
 public:
  /// For n x n matrices.
  explicit SplitAdjointSeries(Index n);

  /// out = e^Ω W e^(-Ω), single matrices each.  The series ends when a term is below rounding
  /// relative to W.  Each factor T_k may be cut to the band of `tail`.  Returns false if 200 terms
  /// do not suffice or a term is not finite.  out is not W.
  bool conjugate(SplitStages& out, const SplitStages& Omega, const SplitStages& W,
                 SplitProducts& products, SingleProducts& single_products, BandTruncation& bands,
                 double tail);

 private:
  SplitStages term_;     // T_{k-1}
  SplitStages next_;     // T_k
  SplitStages product_;  // Ω T_{k-1}
  SingleStages Omega_single_, term_single_, next_single_, product_single_;
};

}  // namespace isosyrk
