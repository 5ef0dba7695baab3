// Clocks: CPU time and the time that passes.
#pragma once

#include <chrono>
#include <ctime>

namespace isosyrk {

/// CPU seconds used by this process so far (all threads).
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Seconds that pass, since some fixed moment.
inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace isosyrk
