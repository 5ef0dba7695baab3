// What the stage systems of Gauss methods share: their operations, and the step that they are bound
// to.
#pragma once

#include "isosyrk/fast/stage_generator.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/solver/alternating_correction.h"
#include "isosyrk/split/split_products.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// A stage system with a Jacobian in two parts, corrected by AlternatingCorrection.
class SplitSystem : public StageSystem, public TwoPartJacobian {
 public:
  Unknowns unknowns() const final;
  void bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) override;
  Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) final {
    return correction_.solve(delta, *this, x, R, request, options);
  }
  /// Sweeps with B frozen.
  void far_sweep(Corrections& delta, const Unknowns& x, const Corrections& R,
                 const IterationOptions& options) final {
    AlternatingCorrection::sweep_frozen(delta, *this, x, R, options);
  }
  bool truncates() const final { return bands_.enabled(); }
  void truncate(bool enabled) final { bands_.enable(enabled); }
  Work work() const final { return work_of(products_, single_products_, generator_); }
  void archive_work(StateArchive& run) final { run.pass(products_, single_products_, generator_); }

 protected:
  /// With kinds[k] unknown matrices of kind k, and the stages W̃_1 ... W̃_s.  Throws
  /// std::invalid_argument for a flow without a generator in split-complex storage, and for threads
  /// out of range.
  SplitSystem(const Flow& flow, std::vector<Index> kinds, Index stages, int threads, bool truncates,
              const CouplingBand& coupling_band);

  // Workspace for the equations.
  SplitMatrix zero() const { return SplitMatrix(products_.size()); }
  SplitStages zeros(Index count) const { return split_stages(count, products_.size()); }
  SingleStages singles(Index count) const { return split_stages<float>(count, products_.size()); }

  /// B_i = B(W_i), to what the tolerance may leave out of h B.
  void generate(Generators& B, const SplitStages& W) {
    generator_.generate(B, W, bands_, left_out_ / std::abs(h_));
  }
  /// S_i = B_i in single precision, with an error of h S of `accuracy`.
  void round_generators(RoundedGenerators& S, const Generators& B, double accuracy) const {
    StageGenerator::round(S, B, bands_, accuracy / std::abs(h_), least_coupling_band_);
  }

  SplitProducts products_;
  SingleProducts single_products_;
  StageGenerator generator_;
  BandTruncation bands_;
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
  double left_out_ = 0.0;  // Frobenius norm that may be cut from an unknown

 private:
  std::vector<Index> kinds_;
  Index least_coupling_band_;
  AlternatingCorrection correction_;
};

/// The SplitSystem of a Runge-Kutta method.
class RungeKuttaSystem : public SplitSystem {
 protected:
  /// Throws std::invalid_argument for an inconsistent tableau, and as SplitSystem.
  RungeKuttaSystem(const Flow& flow, const Tableau& tableau, std::vector<Index> kinds, int threads,
                   bool truncates, const CouplingBand& coupling_band);

  std::size_t stages() const { return static_cast<std::size_t>(s_); }
  /// Returns a_i1 ... a_is.
  auto row(std::size_t i) const { return tableau_.a.row(static_cast<Index>(i)); }
  double a(std::size_t i, std::size_t j) const {
    return tableau_.a(static_cast<Index>(i), static_cast<Index>(j));
  }
  /// Returns b_1 ... b_s.
  const RealVector& b() const { return tableau_.b; }

  Index s_;

 private:
  Tableau tableau_;
};

}  // namespace isosyrk
