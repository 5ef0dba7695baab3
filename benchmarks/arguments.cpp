#include "benchmarks/arguments.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "isosyrk/scenes/scene_list.h"

namespace isosyrk {

long whole_number(const std::string& option, const std::string& text, long least, long most) {
  long value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const bool parsed =
      stop == end && (error == std::errc() || error == std::errc::result_out_of_range);
  if (!parsed) {
    throw BadArgument(
        fmt::format("{} '{}': not a whole number; must be {} to {}", option, text, least, most));
  }
  if (error != std::errc() || value < least || value > most) {
    throw BadArgument(
        fmt::format("{} {}: out of range; must be {} to {}", option, text, least, most));
  }
  return value;
}

double real_number(const std::string& option, const std::string& text, const std::string& allowed,
                   double least, double most) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || error != std::errc()) {
    throw BadArgument(fmt::format("{} '{}': not a number; must be {}", option, text, allowed));
  }
  if (!std::isfinite(value)) {
    throw BadArgument(fmt::format("{} {}: not finite; must be {}", option, text, allowed));
  }
  if (value < least || value > most) {
    throw BadArgument(fmt::format("{} {}: must be {}", option, text, allowed));
  }
  return value;
}

long step_count(double time, double step) {
  constexpr double most = 1e15;  // beyond this a double no longer counts steps
  const double quotient = time / step;
  const double steps = std::round(quotient);
  if (!(quotient <= most)) {
    throw BadArgument(fmt::format("--time {} with --step {}: {} steps; must be at most {}", time,
                                  step, quotient, most));
  }
  if (std::abs(quotient - steps) > 1e-9 * std::max(1.0, quotient)) {
    throw BadArgument(
        fmt::format("--time {} with --step {}: {:.6g} steps; must be a whole number of steps", time,
                    step, quotient));
  }
  return static_cast<long>(steps);
}

int thread_count(const std::string& option, const std::string& text) {
  return static_cast<int>(whole_number(option, text, 1, 64));
}

void note_more_threads_than_cores(const char* program, int threads) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return;
  const int cores = CPU_COUNT(&allowed);
  if (threads <= cores) return;
  print_error(program,
              fmt::format("note: {} threads on {} {}: they take turns, and the run is slower than "
                          "with {}",
                          threads, cores, cores == 1 ? "core" : "cores", cores));
}

void require_scene(const std::string& option, const std::string& text) {
  const std::vector<std::string>& names = scene_names();
  if (std::find(names.begin(), names.end(), text) == names.end()) {
    throw BadArgument(fmt::format("{} '{}': must be {}", option, text, fmt::join(names, ", ")));
  }
}

void require_printed() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout) {
    throw BadArgument("standard output: cannot be written");
  }
}

}  // namespace isosyrk
