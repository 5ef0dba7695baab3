// The choice between two ways to start an iteration, by the errors that they were seen to have.
#pragma once

#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// Chooses between start values from past steps and those of an explicit step, for systems that
/// offer both.  Past steps cost a pass over memory and no products: they are preferred while their
/// error is at most ten times that of the explicit step.  A trial costs no products either.  With a
/// trial every eight steps in place of four, runs of 20 to 100 steps take up to 6 % more products
/// (elp4, elp6 at 1e-8, n = 17, 33, 65, smooth and rough).
class StartChoice {
 public:
  /// True if the next step should start from past steps.
  bool prefers_past() const { return prefers_past_; }
  /// True if the error of past steps should be found after this step, which started explicitly.
  bool is_trial_due() const { return steps_since_trial_ >= trial_interval; }

  /// Records the error of an explicit start: the change of the first sweep.
  void record_explicit(double error) {
    of_explicit_ = error;
    ++steps_since_trial_;
  }
  /// Records the error of a start from past steps, used or in a trial.
  void record_past(double error) {
    prefers_past_ = error <= largest_ratio * of_explicit_;  // false for NaN
    steps_since_trial_ = 0;
  }
  /// Records that a start from past steps failed.
  void record_failure_of_past() { prefers_past_ = false; }

  void forget() { *this = StartChoice(); }
  void archive(StateArchive& state) { state.pass(prefers_past_, steps_since_trial_, of_explicit_); }

 private:
  // Largest error of past steps, as a multiple of that of the explicit step, at which they are
  // preferred.  At 3 exponential methods take up to 18 % more products over T = 50, at 30 between
  // 12 % more and 6 % fewer (elp4, elp6 at 1e-8, n = 17, 33, 65, smooth and rough, 40 to 400
  // steps).
  static constexpr double largest_ratio = 10.0;
  static constexpr int trial_interval = 4;

  bool prefers_past_ = false;
  int steps_since_trial_ = 0;
  double of_explicit_ = 0.0;
};

}  // namespace isosyrk
