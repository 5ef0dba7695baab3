// What the fast integrators share: their state, in split-complex storage.
#pragma once

#include <memory>
#include <utility>

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/step_memory.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// An integrator whose state V = W / scale stays in split-complex storage through a run, with a
/// power of two for the scale (StateScale).  W is converted where the state is set or asked for,
/// not at every step.
///
/// A run is a state and what its steps leave to the next (StepMemory).  A step beside it is a run
/// of its own, of one step, with its own state and memory: for its time it takes the run's place.
///
/// B is linear (SplitGenerator), so that V' = [B(V), V] in the time scale t: a step of size h for W
/// is one of size scale h for V.
class SplitIntegrator : public Integrator {
 public:
  Energy energy() const final;
  int threads() const { return threads_; }

 protected:
  /// Throws std::invalid_argument for a null flow, and for threads out of range.
  SplitIntegrator(const SharedFlow& flow, int threads);

  /// Takes the memory of a run and that of steps beside it, both empty.  Called by constructors of
  /// methods that remember something.
  void remember(std::unique_ptr<StepMemory> of_run, std::unique_ptr<StepMemory> beside);
  /// Returns these, as the type that was taken.  Not to be called in a step.
  template <class Memory>
  Memory& memory_of_run() {
    return static_cast<Memory&>(*run_.memory);
  }
  template <class Memory>
  Memory& memory_beside() {
    return static_cast<Memory&>(*beside_.memory);
  }

  /// Computes V1 from V0 by a step of size h.  The report has all but the work.  The memory is of
  /// the type that was taken.  It is forgotten where the step fails.
  virtual StepReport take_step(SplitStages& V1, const SplitStages& V0, double h,
                               StepMemory& memory) = 0;
  /// Returns the work since construction.
  virtual Work work() const = 0;
  /// Passes what work() counts to an archive, or goes on from what is read: the work of a step is a
  /// difference, whose rounding depends on it.
  virtual void archive_work(StateArchive& run) = 0;
  /// Is told that the state is amended, and has the scale that it had.  Past steps still predict.
  virtual void amended() {}

  /// Returns the V0 of the last step of a run.
  const SplitMatrix& before_last_step() const { return run_.next[0]; }

 private:
  void load(const ConstMatrixView& W) final;
  void amend(const ConstMatrixView& W) final;
  StepReport advance_state(double h) final { return advance(h); }
  void store(MatrixView W) const final;
  StepReport step_alone(MatrixView W, double h) final;
  void archive_run(StateArchive& run) final;
  StepReport advance(double h);
  void take(const ConstMatrixView& W, const StateScale& found);

  struct Run {
    explicit Run(Index n) : V(split_stages(1, n)), next(V), memory(new NoMemory) {}

    StateScale scale;
    SplitStages V;     // a single matrix
    SplitStages next;  // V1 of the step, and then the V before it
    std::unique_ptr<StepMemory> memory;
  };

  int threads_;
  ScaleFinder finder_;
  Run run_;
  Run beside_;  // of steps beside the run; during one of these the run itself
};

}  // namespace isosyrk
