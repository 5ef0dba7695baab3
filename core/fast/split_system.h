// What the stage systems share: their workspace, and the step that they are bound to.
#pragma once

#include "isosyrk/fast/split_workspace.h"
#include "isosyrk/fast/stage_system.h"

namespace isosyrk {

/// A stage system whose operations are those of a SplitWorkspace.
class SplitSystem : public StageSystem {
 public:
  void bind(const SplitMatrix& W0, double h, double tolerance) override {
    W0_ = &W0;
    h_ = h;
    work_.begin_step(h, tolerance);
  }
  bool truncates() const final { return work_.bands.enabled(); }
  void truncate(bool enabled) final { work_.bands.enable(enabled); }
  StepReport work() const final { return work_.work(); }

 protected:
  /// As SplitWorkspace.
  SplitSystem(const Flow& flow, int threads, bool truncates, Index matrices,
              const Tuning::CouplingBand& coupling_band)
      : work_(flow, threads, truncates, matrices, coupling_band) {}

  SplitWorkspace work_;
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
};

}  // namespace isosyrk
