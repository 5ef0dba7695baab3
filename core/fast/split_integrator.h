// What the fast integrators share: their state, in split-complex storage.
#pragma once

#include "isosyrk/fast/fast_options.h"
#include "isosyrk/integrators/integrator.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// An integrator whose state stays in split-complex storage through a run.  W is converted where
/// the state is set or asked for, and compared with the state where it is set, not at every step.
class SplitIntegrator : public Integrator {
 public:
  double energy() const final { return flow().energy(state()); }
  int threads() const { return threads_; }

 protected:
  /// What a step may use of past steps.
  enum class Past {
    used,      ///< past steps predict this one, and it joins them
    left_out,  ///< the step is not of the run: it starts cold and is not remembered
  };

  /// Throws std::invalid_argument for a null flow, and for threads out of range.
  SplitIntegrator(const SharedFlow& flow, int threads);

  /// Computes W1 from W0.  The report has all but the work.
  virtual StepReport take_step(const SplitStages& W0, double h, Past past, SplitStages& W1) = 0;
  /// Returns products, Poisson solves and equivalent products since construction.
  virtual StepReport work() const = 0;
  /// Forgets all past steps, after which the next one starts cold.
  virtual void forget() {}

  /// Returns the W0 of the last step of a run.
  const SplitMatrix& before_last_step() const { return next_[0]; }

 private:
  void load(const ConstMatrixView& W) final;
  StepReport advance_state(double h) final { return advance(h, Past::used); }
  void store(MatrixView W) const final { state_[0].store(W); }
  StepReport step_alone(MatrixView W, double h) final;
  StepReport advance(double h, Past past);
  void exchange(MatrixView W);

  int threads_;
  SplitStages state_;  // a single matrix
  SplitStages next_;   // W1 of the step, and then the state before it
};

}  // namespace isosyrk
