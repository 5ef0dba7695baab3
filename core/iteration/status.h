// Options of an iteration, and how a step ended.
#pragma once

#include <string>
#include <string_view>

namespace isosyrk {

/// How a step ended.
enum class Status {
  converged,
  diverged,   ///< a change was above 1e6 (units as in SolverOptions), or it or W₁ was not finite
  stagnated,  ///< the best change so far was not improved in 50 sweeps
  sweep_cap,  ///< max_sweeps sweeps did not reach the tolerance
};

/// Returns "converged", "diverged", "stagnated" or "sweep cap".
std::string_view name(Status status);

/// Stopping rule of an iteration.  Changes of unknowns that scale with W (W̃, P, X, K) are in units
/// of a power of two near ‖W‖₂ (integrators/state_scale.h), and so relative; those of Q are
/// absolute; those of Ω of exponential methods are relative to ‖Ω‖_F.
struct SolverOptions {
  double tolerance = 1e-13;  ///< on the largest change of an unknown, Frobenius norm
  int max_sweeps = 1000;
  /// Called after every sweep, if set.  It may throw: the step then ends and leaves W unchanged.
  void (*after_sweep)() = nullptr;

  void swept() const {
    if (after_sweep != nullptr) after_sweep();
  }
};

/// How an iteration ended.
struct SolveReport {
  Status status = Status::converged;
  int sweeps = 0;
  double change = 0.0;  ///< largest change of an unknown in the last sweep, as in SolverOptions
  /// Ratio of the changes of two successive sweeps, as the geometric mean of the last five ratios
  /// or of as many as there are.  Below 1 if the iteration contracts; 0 after a single sweep.
  double contraction = 0.0;
};

/// Start values of an iteration.
enum class Start {
  cold,       ///< from the initial state of the step
  predicted,  ///< from past steps, by the predictor
};

/// Kind of iteration.
enum class Iteration {
  none,           ///< the step is explicit
  picard,         ///< Picard sweeps
  newton,         ///< Picard sweeps, each followed by an inexact Newton correction
  frozen_picard,  ///< Picard sweeps, each followed by sweeps with B frozen
  anderson,       ///< Picard sweeps with Anderson acceleration
};

/// One attempt at a step.  If an attempt fails, the integrator makes the next one of its list.
struct Attempt {
  Start start = Start::cold;
  Iteration iteration = Iteration::none;

  bool operator==(const Attempt&) const = default;
};

/// Returns "cold Picard", "predicted Newton", "cold frozen Picard", "cold Anderson" and so on, or
/// "explicit" for Iteration::none.
std::string name(Attempt attempt);

}  // namespace isosyrk
