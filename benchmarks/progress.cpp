#include "benchmarks/progress.h"

#include <fmt/format.h>

#include <cstdio>

namespace isosyrk {

void Progress::say(const std::string& what, const std::string& left) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  std::fputs(
      fmt::format("[{:4.0f} s{}{}] {}\n", elapsed, left.empty() ? "" : ", ", left, what).c_str(),
      stderr);
}

}  // namespace isosyrk
