// What the stage systems share: their workspace, and the step that they are bound to.
#pragma once

#include "isosyrk/fast/split_workspace.h"
#include "isosyrk/fast/stage_system.h"
#include "isosyrk/tableaux/tableau.h"

namespace isosyrk {

/// The stage system of a Runge-Kutta method whose operations are those of a SplitWorkspace.
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
  /// Throws std::invalid_argument for an inconsistent tableau, for a flow without a generator in
  /// split-complex storage, and for threads out of range.
  SplitSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates,
              const Tuning::CouplingBand& coupling_band)
      : work_(flow, threads, truncates, tableau.stages(), coupling_band),
        tableau_(tableau),
        s_(tableau.stages()) {
    require_consistent(tableau);
  }

  /// Returns a_i1 ... a_is.
  auto row(std::size_t i) const { return tableau_.a.row(static_cast<Index>(i)); }

  SplitWorkspace work_;
  Tableau tableau_;
  Index s_;
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
};

}  // namespace isosyrk
