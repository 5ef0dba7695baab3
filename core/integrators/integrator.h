// The contract of a one-step method.
#pragma once

#include "isosyrk/flows/flow.h"
#include "isosyrk/iteration/status.h"

namespace isosyrk {

/// Result and work of one step.
struct StepReport {
  Status status = Status::converged;
  Attempt attempt = {};      ///< the last attempt, to which the status belongs
  int sweeps = 0;            ///< Picard sweeps of all attempts; 0 for explicit methods
  double last_change = 0.0;  ///< of the last sweep, as SolveReport::change
  double contraction = 0.0;  ///< as in SolveReport; 0 for explicit methods
  long products = 0;         ///< n x n complex matrix products
  long poisson_solves = 0;   ///< evaluations of the generator B
  /// Work of the products in full products in double precision.  A triangle or a product in single
  /// precision counts half; a product of banded matrices counts its multiplications.
  double equivalent_products = 0.0;

  /// Adds a substep that follows: sums the work and the sweeps, takes the larger contraction, and
  /// the substep's status, attempt and last change.
  void append(const StepReport& substep);
  /// Sets products, Poisson solves and equivalent products to `after` - `before`.
  void set_work(const StepReport& before, const StepReport& after);
};

/// A one-step method W₀ -> W₁ with its workspace.  The flow must outlive the integrator.
class Integrator {
 public:
  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Advances W, n x n, in place by a step h, which may be negative, and reports the work.  W is
  /// unchanged unless the status is `converged`.  Allocates nothing.  Throws std::invalid_argument
  /// unless W is n x n and h finite.
  StepReport step(MatrixView W, double h);

  // A run keeps its state in the integrator: set_state(W₀), then step(h) as often as wanted, then
  // state(W).
  /// Sets the state to W, n x n.  Throws std::invalid_argument for another size.
  void set_state(const MatrixView& W);
  /// Advances the state, which stays as it is unless the status is `converged`.  Otherwise as
  /// above.
  StepReport step(double h);
  /// Copies the state to W, n x n.
  void state(MatrixView W);

  const Flow& flow() const { return flow_; }

  /// Computes W1 from W0, both n x n, without the state.  W1 is read only if the status is
  /// `converged`.
  virtual StepReport advance(const Matrix& W0, double h, Matrix& W1) = 0;

 protected:
  explicit Integrator(const Flow& flow);

  /// Called by set_state for a state W0.
  virtual void enter(const Matrix& W0);
  /// Computes W from the state V that is reached a time t after `enter`.  By default W = V.
  virtual void leave(double t, const Matrix& V, MatrixView W);

 private:
  const Flow& flow_;
  Matrix state_;
  Matrix next_;
  // Time since set_state: `past_` and then as many steps of one size.
  double past_ = 0.0;
  double h_ = 0.0;
  long steps_ = 0;
};

}  // namespace isosyrk
