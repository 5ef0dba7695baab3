// The contract of a one-step method.
#pragma once

#include <memory>
#include <type_traits>

#include "isosyrk/flows/flow.h"
#include "isosyrk/integrators/state_scale.h"
#include "isosyrk/iteration/attempt.h"
#include "isosyrk/iteration/status.h"
#include "isosyrk/iteration/work.h"
#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// Result and work of one step.
struct StepReport {
  Status status = Status::converged;
  Attempt attempt = {};  ///< the last attempt, to which the status belongs
  int sweeps = 0;        ///< Picard sweeps of all attempts; 0 for explicit methods
  /// Largest change of an unknown in the last sweep, Frobenius norm.  Unknowns that scale with W
  /// are in units of StateScale, those of the group absolute; Ω is relative to its norm, or to
  /// more in the frame (integrators/unit_of_exponent.h).
  double last_change = 0.0;
  double contraction = 0.0;  ///< as in SolveReport; 0 for explicit methods
  Work work = {};

  /// Adds a substep that follows: sums the work and the sweeps, takes the larger contraction, and
  /// the substep's status, attempt and last change.
  void append(const StepReport& substep);
};

/// A one-step method W₀ -> W₁ with its workspace.  It shares the ownership of its flow.
///
/// A run keeps its state in the integrator: set_state(W₀), then step(h) as often as wanted, then
/// state().  step(W, h) is a single step beside any run.
///
/// **A run in parts.**  The matrix that was set or returned last is known, bit for bit, until a
/// step changes the state.  To set it again changes nothing: the run goes on as if it had not been
/// left, with its past steps, its scale, its frame and its trace.
///
/// **A trace.**  For a flow that ignores_trace(), W = V + icI moves as V does, but ISOSYRK methods
/// do not commute with the shift.  So integrators hold V, with c = Im tr W / n, and add icI where
/// the state is asked for.  Scale, tolerance and energy are those of V.  The diagonal of the state
/// is rounded to a unit in the last place of c where |c| is larger than V.  A state that no step
/// has changed is returned bit for bit.  A trace of the size of rounding stays in V.
class Integrator {
 public:
  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Sets the state to W, n x n.  A new run begins, unless W is known.  Throws
  /// std::invalid_argument for another size, and as QuadraticAlgebra::pack; the state is then
  /// unchanged.  Allocates nothing.
  void set_state(const ConstMatrixView& W);
  /// Sets the state to W, as a run changes it between two of its steps.  Past steps go on
  /// predicting the next one, for its start values only; a multistep method begins its past anew.
  /// The scale is found again only if ‖W‖_F has changed twofold since it was found.  If W is known,
  /// nothing changes.  Throws as set_state.
  void amend_state(const ConstMatrixView& W);
  /// Advances the state by a step h, which may be negative, and reports the work.  The state is
  /// unchanged unless the status is `converged`.  Allocates nothing.  Throws std::invalid_argument
  /// unless h is finite.
  StepReport step(double h);
  /// Copies the state to W, n x n.
  void state(MatrixView W) const;
  /// Returns the state, n x n.
  Matrix state() const;
  /// Returns H of the state, without a trace that the flow ignores, at any norm if H is quadratic.
  virtual Energy energy() const = 0;

  /// Advances W, n x n, in place by a step h, and leaves a run with all that its steps use as it
  /// is.  No past steps predict the step: for several steps keep the state in the integrator.  W is
  /// unchanged unless the status is `converged`.  During the step W is workspace.  Allocates
  /// nothing.  Throws as set_state and step.
  StepReport step(MatrixView W, double h);

  /// Writes the run to an archive, or goes on with a run that is read from one: the state, and all
  /// that past steps leave to the next.  The steps after it are those of the run that was written,
  /// bit for bit.  What was written is read by an integrator of the same method, flow, tolerance
  /// and other options, on any number of threads.  Throws as StateArchive::pass; a state must then
  /// be set before the next step.
  void archive(StateArchive& run);

  const Flow& flow() const { return *flow_; }

  /// Makes this the inner method of another integrator, which knows its states and sets traces
  /// aside.  This one then does neither.
  void make_inner();

 protected:
  /// Throws std::invalid_argument for a null flow.
  explicit Integrator(SharedFlow flow);

 private:
  // All of these see W without a trace that is set aside.

  /// Begins a run from W, n x n.  If it throws, the state is unchanged.
  virtual void load(const ConstMatrixView& W) = 0;
  /// Implements amend_state.
  virtual void amend(const ConstMatrixView& W) = 0;
  /// Advances the state by a step h, or leaves it if the status is not `converged`.
  virtual StepReport advance_state(double h) = 0;
  /// Copies the state to W, n x n.
  virtual void store(MatrixView W) const = 0;
  /// Implements step(W, h), for W, n x n, and finite h.
  virtual StepReport step_alone(MatrixView W, double h) = 0;
  /// Implements archive() for the state and for all that a step leaves to the next.
  virtual void archive_run(StateArchive& run) = 0;

  double trace_of(const ConstMatrixView& W) const;
  template <class Take>
  void change_state(const ConstMatrixView& W, const Take& take);

  SharedFlow flow_;
  bool is_inner_ = false;
  double trace_ = 0.0;  // c, set aside from the state
  // The state as it was set or returned last, if no step has changed it since.
  mutable Matrix known_;
  mutable bool is_known_ = false;
  Eigen::VectorXcd diagonal_;  // of the W of a lone step
};

/// Calls exchange() when it is made and when it ends, by an exception too.
template <class Exchange>
class Exchanged {
 public:
  explicit Exchanged(Exchange exchange) : exchange_(std::move(exchange)) { exchange_(); }
  ~Exchanged() { exchange_(); }
  Exchanged(const Exchanged&) = delete;
  Exchanged& operator=(const Exchanged&) = delete;

 private:
  Exchange exchange_;
};

/// The flow that an integrator in real or complex arithmetic is made for.
template <class Scalar>
using FlowIn = std::conditional_t<std::is_same_v<Scalar, double>, RealFlow, Flow>;
template <class Scalar>
using SharedFlowIn = std::shared_ptr<const FlowIn<Scalar>>;

/// An integrator whose state is a matrix V = W / scale in storage (linalg/quadratic_algebra.h), of
/// real or complex numbers, with a power of two for the scale (StateScale).  A linear B is called
/// with V, which obeys V' = [B(V), V] in the time scale t; another B is called with W.
template <class Scalar>
class IntegratorIn : public Integrator {
 public:
  using Stored = MatrixOf<Scalar>;

  /// Computes W1 from W0, both in storage and in units of the scale, without the state; if B is
  /// linear h is scale times the step.  W1 is read only if the status is `converged`.
  virtual StepReport advance(const Stored& W0, double h, Stored& W1) = 0;

  /// Sets the scale, a power of two, for advance().
  virtual void set_scale(double scale) { scale_ = scale; }

  Energy energy() const final;

 protected:
  explicit IntegratorIn(SharedFlowIn<Scalar> flow);

  /// B = B(V) if B is linear, otherwise B(scale V), of V projected onto g.
  void evaluate(const Stored& V, Stored& B);

  /// Forgets all past steps of the run, after a step that failed and before a state that is set.
  virtual void forget() {}
  /// Passes all past steps of the run to an archive, or takes them from it: what forget() forgets.
  virtual void archive_past(StateArchive&) {}
  /// True during a lone step, which neither uses past steps of the run nor joins them.
  bool is_alone() const { return is_alone_; }

  /// Returns Flow::rotation_left_out of V, for an h as of advance().  Only a linear B leaves one
  /// out.
  double rotation_left_out(const Stored& V) const;

 private:
  void load(const ConstMatrixView& W) final;
  void amend(const ConstMatrixView& W) final;
  StepReport advance_state(double h) final;
  void store(MatrixView W) const final;
  StepReport step_alone(MatrixView W, double h) final;
  void archive_run(StateArchive& run) final;
  void take(const StateScale& found);
  void exchange(MatrixView W, const StateScale& of_W);
  void generate(const Stored& W, Stored& B) const;

  const FlowIn<Scalar>& flow_;  // owned by Integrator
  ScaleFinder finder_;
  StateScale found_;
  double scale_ = 1.0;  // found_.value, or that of the integrator of which this is a substep
  Stored state_;
  Stored next_;
  Stored argument_;  // of a B that is not linear; empty otherwise
  bool is_alone_ = false;
};

/// Makes Method<double> for a RealFlow, and Method<Complex> for another flow.
template <template <class> class Method, class... Arguments>
std::unique_ptr<Integrator> make_in_arithmetic_of(const SharedFlow& flow,
                                                  const Arguments&... arguments) {
  if (const auto real_flow = std::dynamic_pointer_cast<const RealFlow>(flow)) {
    return std::make_unique<Method<double>>(real_flow, arguments...);
  }
  return std::make_unique<Method<Complex>>(flow, arguments...);
}

}  // namespace isosyrk
