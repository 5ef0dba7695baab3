// The integrator of the fast forms.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "isosyrk/fast/fast_substep.h"
#include "isosyrk/fast/split_integrator.h"

namespace isosyrk {

/// A one-step method in split-complex storage.  It gives the answer of the published form to the
/// solver's tolerance.  A step is one substep, or several in a row: a composition.  Substep
/// k is predicted from substep k of earlier steps; the fractions may differ.  There is no
/// prediction from a state other than the last W₁.
class FastIntegrator final : public SplitIntegrator {
 public:
  using MakeSystem = std::function<std::unique_ptr<StageSystem>()>;

  /// make_system() returns the stage system of one substep, for this flow and for at least
  /// options.threads threads.  Substep k has size fractions[k] h; a method without substeps has
  /// one.  Throws std::invalid_argument for options out of range.
  FastIntegrator(const SharedFlow& flow, const MakeSystem& make_system, const FastOptions& options,
                 std::vector<double> fractions = {1.0});

  /// Returns the change of one more Picard sweep of the last substep, without band truncation, from
  /// the unknowns of the last step of a run, which must have converged.  Checks the tolerance
  /// independently of the solver, and disturbs no later step.  Not to be called for a run that was
  /// read from an archive, before its next step.
  double change_of_one_more_sweep();

  /// True if products skip entries outside bands.
  bool truncates() const { return substeps_[0].system().truncates(); }

 private:
  // What a step leaves to the next one.
  struct Memory final : StepMemory {
    void forget() override;
    void archive(StateArchive& state) override { state.pass(of_substeps); }

    std::vector<SubstepMemory> of_substeps;
    SplitStages between;  // the states after each substep but the last
    double h = 0.0;
  };

  std::unique_ptr<Memory> empty_memory(bool of_run) const;
  StepReport take_step(SplitStages& W1, const SplitStages& W0, double h,
                       StepMemory& memory) override;
  Work work() const override;
  void archive_work(StateArchive& run) override;

  std::vector<double> fractions_;
  std::vector<FastSubstep> substeps_;
};

}  // namespace isosyrk
