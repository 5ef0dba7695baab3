// Workspace of the stage systems: products, generator and band truncation in split-complex storage.
#pragma once

#include <memory>

#include "isosyrk/flows/flow.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_products.h"

namespace isosyrk {

/// Operations of a stage system, counted.  begin_step(), generate(), round_generators() and
/// generate_coupled() are called in this order.  They do not allocate.
class SplitWorkspace {
 public:
  /// For up to `matrices` matrices at a time.  Throws std::invalid_argument for a flow without a
  /// generator in split-complex storage, and for threads out of range.
  SplitWorkspace(const Flow& flow, int threads, bool truncates, Index matrices,
                 const Tuning::CouplingBand& coupling_band);

  Index size() const { return products.size(); }
  SplitMatrix zero() const { return SplitMatrix(size()); }
  SplitMatrix identity() const;
  SplitStages zeros(Index count) const { return split_stages(count, size()); }
  SingleStages singles(Index count) const { return split_stages<float>(count, size()); }

  /// Begins a step.  |h| and the tolerance of the solver fix the tails of band truncation.
  void begin_step(double h, double tolerance);
  /// Returns the Frobenius norm that may be cut from an unknown.
  double left_out() const { return left_out_; }

  /// B_i = B(W_i), truncated to left_out() / |h|.  Reads the upper triangles of W_i.
  void generate(const SplitStages& W, SplitStages& B);
  /// S_i = B_i of the last generate() in single precision, truncated to accuracy / |h|.  Sets
  /// coupling_band().
  void round_generators(double accuracy, const SplitStages& B, SingleStages& S);
  /// Returns the band of δW̃ and of B(δW̃) in the coupling through B.
  Index coupling_band() const { return coupling_band_; }
  /// dB_i = B(dW_i) within coupling_band().  Reads the upper triangles of dW_i.
  void generate_coupled(const SingleStages& dW, SingleStages& dB);

  /// Returns a c with ‖B(W)‖_F <= c ‖W‖_F.
  double generator_bound() const { return generator_->norm_bound(); }

  /// Returns products, Poisson solves and equivalent products since construction.
  StepReport work() const;

  SplitProducts products;
  SingleProducts single_products;
  BandTruncation bands;

 private:
  std::unique_ptr<SplitGenerator> generator_;
  long solves_ = 0;
  Index least_coupling_band_;
  Index coupling_band_ = 0;
  double h_ = 0.0;  // |h| of the current step
  double left_out_ = 0.0;
};

}  // namespace isosyrk
