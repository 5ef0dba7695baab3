// What the fast integrators share: their state, in split-complex storage.
#pragma once

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/past.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// An integrator whose state V = W / scale stays in split-complex storage through a run, with a
/// power of two for the scale (StateScale).  W is converted where the state is set or asked for,
/// not at every step.  A lone step has a state and a memory of its own.
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

  /// Computes V1 from V0 by a step of size h.  The report has all but the work.
  virtual StepReport take_step(SplitStages& V1, const SplitStages& V0, double h, Past past) = 0;
  /// Returns the work since construction.
  virtual Work work() const = 0;
  /// Forgets all past steps, after which the next one starts cold.
  virtual void forget() {}
  /// Is told that the state is amended, and has the scale that it had.  Past steps still predict.
  virtual void amended() {}
  /// Exchanges all that the last step has left, but what only Past::used reads, with what was left
  /// at the call before.  A lone step is made between two calls.  Allocates nothing.
  virtual void exchange_memory() {}

  /// Returns the V0 of the last step of a run.
  const SplitMatrix& before_last_step() const { return state_.next[0]; }

 private:
  void load(const ConstMatrixView& W) final;
  void amend(const ConstMatrixView& W) final;
  StepReport advance_state(double h) final { return advance(h, Past::used); }
  void store(MatrixView W) const final;
  StepReport step_alone(MatrixView W, double h) final;
  StepReport advance(double h, Past past);
  void take(const ConstMatrixView& W, const StateScale& found);

  // Of a run, or of a lone step.
  struct State {
    explicit State(Index n) : V(split_stages(1, n)), next(V) {}

    StateScale scale;
    SplitStages V;     // a single matrix
    SplitStages next;  // V1 of the step, and then the V before it
  };

  int threads_;
  ScaleFinder finder_;
  State state_;
  State other_state_;  // of a lone step; during that, of the run
};

}  // namespace isosyrk
