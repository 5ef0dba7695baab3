// Lines of progress on stderr: what a long run is at, since when, and for how long still.
#pragma once

#include <chrono>
#include <string>

namespace isosyrk {

class Progress {
 public:
  /// Prints "[elapsed s, left] what", without the comma where `left` is empty.
  void say(const std::string& what, const std::string& left) const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace isosyrk
