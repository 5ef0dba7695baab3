// How an iteration is asked to solve a step, and how it ended.
#pragma once

#include <string>
#include <string_view>

namespace isosyrk {

/// How a step ended.
enum class Status {
  converged,
  diverged,   ///< a change was not finite or above 1e6
  stagnated,  ///< the best change so far was not improved in 50 sweeps
  sweep_cap,  ///< max_sweeps reached while still falling
};

/// "converged", "diverged", "stagnated", "sweep cap".
std::string_view name(Status status);

/// When an iteration stops.
struct SolverOptions {
  double tolerance = 1e-13;  ///< absolute, on the largest change of an unknown
  int max_sweeps = 1000;
};

/// How an iteration ended.
struct SolveReport {
  Status status = Status::converged;
  int sweeps = 0;
  double change = 0.0;  ///< of the last sweep
  /// Change of the last sweep over that of the one before, geometric mean over the last five sweeps
  /// (fewer if there were fewer; 0 for a single sweep): below 1 where the iteration contracts.
  double contraction = 0.0;
};

/// Where an iteration starts.
enum class Start {
  cold,       ///< from the initial state of the step
  predicted,  ///< from past steps
};

/// How an iteration goes on.
enum class Iteration {
  none,           ///< the step is explicit
  picard,         ///< Picard sweeps
  newton,         ///< Picard sweeps, each followed by an inexact Newton correction
  frozen_picard,  ///< Picard sweeps, each followed by sweeps with B frozen
  anderson,       ///< Picard sweeps with Anderson acceleration
};

/// One of the ways to solve a step: if one fails, the next is tried.
struct Attempt {
  Start start = Start::cold;
  Iteration iteration = Iteration::none;

  bool operator==(const Attempt&) const = default;
};

/// "cold Picard", "predicted Newton", "cold frozen Picard", "cold Anderson" and so on; "explicit"
/// where there is no iteration.
std::string name(Attempt attempt);

}  // namespace isosyrk
