#include "isosyrk/iteration/faults.h"

#ifdef ISOSYRK_FAULTS
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace isosyrk {
namespace {

struct Order {
  std::optional<Fault> fault;
  double share = 0.0;  // of a slowdown
};

constexpr std::pair<const char*, Fault> names[] = {
    {"allocation", Fault::allocation},
    {"extra_sweep", Fault::extra_sweep},
    {"printed_index", Fault::printed_index},
    {"single_precision", Fault::single_precision},
    {"skewness", Fault::skewness},
    {"slowdown", Fault::slowdown},
    {"tableau", Fault::tableau},
    {"tolerance", Fault::tolerance},
};

Order read_order() {
  const char* given = std::getenv("ISOSYRK_FAULT");
  if (given == nullptr) return {};
  const std::string text = given;
  const auto colon = text.find(':');
  for (const auto& [name, fault] : names) {
    if (text.substr(0, colon) != name) continue;
    Order order{fault};
    if (fault != Fault::slowdown && colon == std::string::npos) return order;
    char* end = nullptr;
    if (fault == Fault::slowdown && colon != std::string::npos) {
      order.share = std::strtod(text.c_str() + colon + 1, &end);
      if (*end == '\0' && order.share > 0.0 && order.share <= 10.0) return order;
    }
  }
  throw std::invalid_argument(fmt::format(
      "ISOSYRK_FAULT={}: must be one of core/faults.h, slowdown with a share as slowdown:0.05",
      text));
}

const Order& order() {
  static const Order given = read_order();
  return given;
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double cost_of_reading_the_clock() {
  constexpr int readings = 1000;
  const Clock::time_point start = Clock::now();
  for (int k = 1; k < readings; ++k) static_cast<void>(Clock::now());
  return seconds_since(start) / readings;
}

// Waits for a share of the time since it last returned, which is that of one sweep.  What reading
// the clock costs is counted as waiting: once before, and about one and a half times after.
void wait_for_share(double share) {
  static const double reading = cost_of_reading_the_clock();
  static Clock::time_point last = Clock::now();
  static double typical = std::numeric_limits<double>::infinity();
  const double passed = seconds_since(last);
  // Several times more is not a sweep but what lay between two runs.
  const double sweep = std::min(passed, 4.0 * typical) - reading;
  typical = std::min(1.5 * typical, passed);
  const double until = passed + share * sweep - 2.5 * reading;
  while (seconds_since(last) < until) {
  }
  last = Clock::now();
}

}  // namespace

bool has_fault(Fault fault) { return order().fault == fault; }

void disturb_sweep() {
  if (has_fault(Fault::slowdown)) wait_for_share(order().share);
  if (has_fault(Fault::allocation)) {
    void* volatile allocated = std::malloc(1);  // volatile: or the compiler would leave it out
    std::free(allocated);
  }
}

}  // namespace isosyrk
#endif
