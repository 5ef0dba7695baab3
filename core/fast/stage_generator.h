// The generators B(W̃_i) of the stages in split-complex storage, counted, within bands.
#pragma once

#include <algorithm>
#include <memory>

#include "isosyrk/flows/flow.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/iteration/work.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Generators B_i of stages in double precision.
struct Generators {
  SplitStages B;
  DiagonalSquares squares;  ///< of B before it was cut to its bands

  const SplitMatrix& operator[](std::size_t i) const { return B[i]; }
};

/// Generators B_i rounded for the Jacobian, and the band of the coupling through B.
struct RoundedGenerators {
  SingleStages B;
  Index coupling_band;  ///< of δW̃ and of B(δW̃)

  const SingleMatrix& operator[](std::size_t i) const { return B[i]; }
};

/// Lower bound on the band of the coupling K.  Beyond it Δ⁻¹ damps the contribution below single
/// precision.  The bound of each form was measured as the constants of Tuning were.
struct CouplingBand {
  Index floor;
  double of_n;
  Index operator()(Index n) const {
    return std::max(floor, static_cast<Index>(of_n * static_cast<double>(n)));
  }
};

/// B of a flow, for stages.  Only the constructor and the makers of workspace allocate.
class StageGenerator {
 public:
  /// Throws std::invalid_argument for a flow without a generator in split-complex storage.
  explicit StageGenerator(const Flow& flow);

  /// Returns workspace for `count` generators.
  Generators generators(Index count) const {
    return {split_stages(count, n_), diagonal_squares(count, n_)};
  }
  RoundedGenerators rounded(Index count) const { return {split_stages<float>(count, n_), n_ - 1}; }

  /// Returns the least band of the coupling through B: that of `band`, or n - 1 if B does not damp
  /// fine scales.
  Index least_coupling_band(const CouplingBand& band) const;

  /// B_i = B(W_i), cut to the band of `tail`.  Reads the upper triangles of W_i.
  void generate(Generators& B, const SplitStages& W, const BandTruncation& bands, double tail);
  /// S_i = B_i in single precision, cut to the band of `tail`.  The coupling band becomes the
  /// widest of these, at least least_band.
  static void round(RoundedGenerators& S, const Generators& B, const BandTruncation& bands,
                    double tail, Index least_band);
  /// B = B(W) for one matrix, within the band of W.  Reads the upper triangle of W.
  template <class Real>
  void generate_one(SplitMatrixOf<Real>& B, const SplitMatrixOf<Real>& W);
  /// dB_i = B(dW_i) within a band.  Reads the upper triangles of dW_i.
  void generate_within(SingleStages& dB, Index band, const SingleStages& dW);

  /// As SplitGenerator::rotation_left_out.
  double rotation_left_out(const SplitMatrix& W) const { return generator_->rotation_left_out(W); }
  /// Returns a c with ‖B(W)‖_F <= c ‖W‖_F.
  double norm_bound() const { return generator_->norm_bound(); }
  /// Returns the number of evaluations of B since construction.
  long solves() const { return solves_; }
  /// Passes that number to an archive, or goes on from one that is read.
  void archive(StateArchive& counts) { counts.pass(solves_); }

 private:
  Index n_;
  std::unique_ptr<SplitGenerator> generator_;
  long solves_ = 0;
};

/// Returns the work of these products and of this generator since construction.
inline Work work_of(const SplitProducts& products, const SingleProducts& single_products,
                    const StageGenerator& generator) {
  // A product in single precision counts half: vectors hold twice as many numbers.
  return {.products = products.count() + single_products.count(),
          .equivalent_products = products.equivalents() + 0.5 * single_products.equivalents(),
          .poisson_solves = generator.solves()};
}

}  // namespace isosyrk
