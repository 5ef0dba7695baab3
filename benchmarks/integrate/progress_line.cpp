#include "benchmarks/integrate/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace isosyrk {
namespace {

constexpr std::chrono::milliseconds interval(250);
constexpr const char* erase = "\r\x1b[K";  // return to the first column, and clear the line

}  // namespace

ProgressLine::ProgressLine(long steps, double step, bool wanted)
    : steps_(steps),
      step_(step),
      shown_(wanted && isatty(STDERR_FILENO) != 0),
      begun_(Clock::now()),
      next_(begun_) {
  show(0);
}

void ProgressLine::show(long done) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + interval;
  std::string left;
  if (done > 0) {
    const double passed = std::chrono::duration<double>(now - begun_).count();
    const auto share = static_cast<double>(steps_ - done) / static_cast<double>(done);
    left = fmt::format(", about {} left", duration_text(passed * share));
  }
  const auto percent = steps_ == 0 ? 100 : 100 * done / steps_;
  std::fputs(fmt::format("{}step {} of {} ({} %), t = {:.6g}{}", erase, done, steps_, percent,
                         static_cast<double>(done) * step_, left)
                 .c_str(),
             stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (!shown_) return;
  shown_ = false;
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
