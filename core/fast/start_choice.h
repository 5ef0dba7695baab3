// The choice between two ways to start an iteration, by the errors that they were seen to have.
#pragma once

namespace isosyrk {

/// Chooses between start values from past steps and those of an explicit step, for systems that
/// offer both.  Past steps cost a pass over memory and no products: they are preferred while their
/// error is at most Tuning::predicted_error times that of the explicit step.  A trial costs no
/// products either.  With a trial every eight steps in place of four, runs of 20 to 100 steps take
/// up to 6 % more products (elp4, elp6 at 1e-8, n = 17, 33, 65, smooth and rough).
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
  void record_past(double error);
  /// Records that a start from past steps failed.
  void record_failure_of_past() { prefers_past_ = false; }

  void forget() { *this = StartChoice(); }

 private:
  static constexpr int trial_interval = 4;

  bool prefers_past_ = false;
  int steps_since_trial_ = 0;
  double of_explicit_ = 0.0;
};

}  // namespace isosyrk
