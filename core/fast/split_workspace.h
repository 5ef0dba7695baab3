// What the stage systems work with: products, generator and band truncation in split storage.
#pragma once

#include <memory>

#include "isosyrk/flows/flow.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Operations of a stage system, counted.  Allocates in the constructor only.
class SplitWorkspace {
 public:
  /// For up to `matrices` matrices at a time.  Throws std::invalid_argument for a flow that has no
  /// generator in split storage.
  SplitWorkspace(const Flow& flow, int threads, bool truncates, Index matrices,
                 const Tuning::CouplingBand& coupling_band);

  Index size() const { return products.size(); }
  SplitMatrix zero() const { return SplitMatrix(size()); }
  SplitMatrix identity() const;
  SplitStages zeros(Index count) const { return split_stages(count, size()); }
  SingleStages singles(Index count) const { return split_stages<float>(count, size()); }

  /// The step begins: bounds on what may be left out follow from |h| and the tolerance.
  void begin_step(double h, double tolerance);
  /// What may be left out of an unknown, in the Frobenius norm.
  double left_out() const { return left_out_; }

  /// B_i = B(W_i) cut to what counts in this step, from the upper triangles of W_i.
  void generate(const SplitStages& W, SplitStages& B);
  /// S_i = B_i in single precision, cut to what counts to a relative accuracy; B_i from the last
  /// generate().  Fixes the band of the coupling for generate_coupled().
  void round_generators(double accuracy, const SplitStages& B, SingleStages& S);
  /// Diagonals of W̃ and B through which the coupling K acts.
  Index coupling_band() const { return coupling_band_; }
  /// dB_i = B(dW_i) within the band of the coupling, from the upper triangles of dW_i.
  void generate_coupled(const SingleStages& dW, SingleStages& dB);

  /// A number c with ‖B(W)‖_F <= c ‖W‖_F.
  double generator_bound() const { return generator_->norm_bound(); }

  StepReport work() const;

  SplitProducts products;
  SingleProducts single_products;
  BandTruncation bands;

 private:
  std::unique_ptr<SplitGenerator> generator_;
  long solves_ = 0;
  Index least_coupling_band_;
  Index coupling_band_ = 0;
  double h_ = 0.0;  // |h| of the step under way
  double left_out_ = 0.0;
};

}  // namespace isosyrk
