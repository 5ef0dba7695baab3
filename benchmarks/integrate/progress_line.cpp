#include "benchmarks/integrate/progress_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace isosyrk {
namespace {

constexpr std::chrono::milliseconds of_terminal(250);
constexpr const char* erase = "\r\x1b[K";  // return to the first column, and clear the line

// A longer line would go on in the next one, which is not cleared.
std::string cut_to_terminal(const std::string& line) {
  winsize size{};
  const bool is_known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return is_known ? line.substr(0, std::size_t{size.ws_col} - 1U) : line;
}

}  // namespace

ProgressLine::ProgressLine(long steps, double step, bool wanted, const Progress& begun,
                           Clock::duration of_log)
    : steps_(steps),
      step_(step),
      shown_(wanted),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      first_(begun.steps),
      interval_(is_terminal_ ? of_terminal : of_log),
      begun_(Clock::now()),
      next_(is_terminal_ ? begun_ : begun_ + interval_) {
  show(begun);
}

std::string ProgressLine::text(const Progress& done, Clock::time_point now) const {
  const auto percent = steps_ == 0 ? 100 : 100 * done.steps / steps_;
  std::string line =
      fmt::format("step {} of {} ({} %), t = {:.6g}, energy {:.8g}", done.steps, steps_, percent,
                  static_cast<double>(done.steps) * step_, done.energy);
  if (done.sweeps > 0) {
    line += fmt::format(", {:.3g} sweeps a step",
                        static_cast<double>(done.sweeps) / static_cast<double>(done.steps));
  }
  if (done.steps > first_) {
    const double passed = std::chrono::duration<double>(now - begun_).count();
    const auto share =
        static_cast<double>(steps_ - done.steps) / static_cast<double>(done.steps - first_);
    line += fmt::format(", about {} left", duration_text(passed * share));
  }
  return line;
}

void ProgressLine::show(const Progress& done) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + interval_;
  const std::string line = text(done, now);
  std::fputs((is_terminal_ ? erase + cut_to_terminal(line) : line + '\n').c_str(), stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!shown_) return;
  shown_ = false;
  if (!is_terminal_) return;
  std::fputs(erase, stderr);
  std::fflush(stderr);
}

std::string duration_text(double seconds) {
  const long whole = std::lround(std::fmin(seconds, 1e9));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace isosyrk
