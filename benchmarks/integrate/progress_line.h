// Progress of a long run, on a terminal or in a log.
#pragma once

#include <chrono>
#include <string>

namespace isosyrk {

/// How far a run has come.
struct Progress {
  long steps = 0;
  double energy = 0.0;
  long sweeps = 0;  ///< of all steps; 0 for an explicit method
};

/// One line on stderr with the steps done, the energy, the sweeps a step, and the time left.  On a
/// terminal it is rewritten at most four times a second, and gone at the end; elsewhere, as in the
/// log of a cluster, it is a line a minute.
class ProgressLine {
 public:
  using Clock = std::chrono::steady_clock;

  /// Shows nothing at all unless `wanted`.  The run has `steps` steps of size `step`, and begins
  /// with some of them done.
  ProgressLine(long steps, double step, bool wanted, const Progress& begun = {},
               Clock::duration of_log = std::chrono::minutes(1));
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// To be called after every step.
  void show(const Progress& done);
  /// Removes the line, so that another can be printed in its place.
  void clear();

 private:
  std::string text(const Progress& done, Clock::time_point now) const;

  long steps_;
  double step_;
  bool shown_;
  bool is_terminal_;
  long first_;  // steps done when it began
  Clock::duration interval_;
  Clock::time_point begun_;
  Clock::time_point next_;
};

/// Returns a duration as people say it: "12 s", "3 min 20 s" or "5 h 7 min".
std::string duration_text(double seconds);

}  // namespace isosyrk
