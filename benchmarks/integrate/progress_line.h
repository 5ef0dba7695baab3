// Progress of a long run on a terminal.
#pragma once

#include <chrono>
#include <string>

namespace isosyrk {

/// One line on stderr, rewritten at most four times a second, with the steps done and the time
/// left. It is shown only if stderr is a terminal, and is gone at the end.
class ProgressLine {
 public:
  /// Shows nothing at all unless `wanted`.
  ProgressLine(long steps, double step, bool wanted);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// To be called after every step with how many are done.
  void show(long done);
  /// Removes the line, so that another can be printed in its place.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  long steps_;
  double step_;
  bool shown_;
  Clock::time_point begun_;
  Clock::time_point next_;
};

/// Returns a duration as people say it: "12 s", "3 min 20 s" or "5 h 7 min".
std::string duration_text(double seconds);

}  // namespace isosyrk
