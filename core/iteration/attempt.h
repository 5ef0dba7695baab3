// The attempts at a step: where the iteration starts, and what kind it is.
#pragma once

#include <string>

namespace isosyrk {

/// Start values of an iteration.
enum class Start {
  cold,       ///< from the initial state of the step
  predicted,  ///< from past steps, by the predictor
  stepped,    ///< from a step of an explicit method
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
