// Brackets and generators of single matrices in split-complex storage.
#pragma once

#include <span>

#include "isosyrk/fast/stage_generator.h"
#include "isosyrk/integrators/lie_operations.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

/// LieOperations of the fast forms, in one precision: what ModifiedGradient and MagnusExponent are
/// written with.  All results are cut to bands, if these are enabled.  Products, generator and
/// bands must outlive it.  Only the constructor allocates.
template <class Real>
class SplitLie {
 public:
  using M = SplitMatrixOf<Real>;

  SplitLie(SplitProductsOf<Real>& products, StageGenerator& generator, BandTruncation& bands)
      : products_(products),
        generator_(generator),
        bands_(bands),
        product_(products.size()),
        term_(products.size()) {}

  M zero() const { return M(products_.size()); }

  /// Sets the part of its Frobenius norm that may be cut from each result.
  void neglect(double part) { neglected_ = part; }
  /// True if anything is cut.
  bool cuts() const { return bands_.enabled(); }
  /// Cuts X in the same way.
  void cut(M& X) { cut_to_part(X, neglected_); }
  /// Cuts X to a band outside which it has at most this part of its Frobenius norm.
  void cut_to_part(M& X, double part) { bands_.truncate_symmetric_to_part(X, part); }

  /// out = Σ weight X, in one pass.
  void combine(M& out, std::span<const WeightedTerm<M>> terms) {
    LinearCombination<Real> sum;
    for (const auto& [weight, X] : terms) sum.add(weight, *X);
    out = sum;
  }
  /// out = scale [A, B] for skew-Hermitian A and B, by one product.
  void bracket(M& out, const M& A, const M& B, double scale = 1.0) {
    products_.form(into(product_, A * B));
    skew_part(out, product_, scale);
    cut(out);
  }
  /// out += scale [A, B].
  void add_bracket(M& out, const M& A, const M& B, double scale = 1.0) {
    bracket(term_, A, B, scale);
    out = out + term_;
  }
  /// B = B(W).
  void generate(M& B, const M& W) {
    generator_.generate_one(B, W);
    cut(B);
  }
  /// D = B(k), since B is linear.
  void differentiate(M& D, const M&, const M& k) { generate(D, k); }

 private:
  SplitProductsOf<Real>& products_;
  StageGenerator& generator_;
  BandTruncation& bands_;
  double neglected_ = 0.0;
  M product_;  // A B
  M term_;     // a bracket to be added
};

}  // namespace isosyrk
