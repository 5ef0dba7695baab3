// Fuzzes the reading of command lines.  An input is a command line of integrate, one argument a
// line; each line is tried as a value by itself too.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>

#include "benchmarks/integrate_arguments.h"
#include "tests/fuzz/property.h"

namespace isosyrk::fuzzing {
namespace {

// An argument ends at a zero, so that this ends a line too.
std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines = {""};
  for (const char c : text) {
    if (c == '\n' || c == '\0') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

// Digits, perhaps after a minus: what strtol reads without skipping blanks or taking a plus.
bool is_plain(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

void check_whole_number(const std::string& text) {
  constexpr long least = -20;
  constexpr long most = 4096;
  const auto value = accepted([&] { return whole_number("--n", text, least, most); });
  errno = 0;
  const long expected = std::strtol(text.c_str(), nullptr, 10);
  const bool allowed = is_plain(text) && errno == 0 && least <= expected && expected <= most;
  require(value.has_value() == allowed,
          "a whole number in the range is accepted, and nothing else");
  if (value) require(*value == expected, "a whole number is what its digits say");
}

std::optional<double> check_real_number(const std::string& text) {
  const auto value = accepted([&] { return real_number("--step", text, "finite"); });
  if (!value) return std::nullopt;
  require(std::isfinite(*value), "an accepted number is finite");
  char* end = nullptr;
  const double expected = std::strtod(text.c_str(), &end);
  require(*end == '\0' && *value == expected, "a number is what the C library reads");
  const auto again = accepted([&] { return real_number("--step", fmt::format("{}", *value), ""); });
  require(again == value, "a number written out is read again");
  return value;
}

// As the comment on step_count has it, relative to the longer of T and h.
void require_whole_steps(double time, double step, long steps) {
  require(0 <= steps && steps <= 1'000'000'000'000'000, "steps can be counted");
  const long double off = static_cast<long double>(steps) * step - time;
  require(std::abs(off) <= 1.001e-9L * std::max(step, time), "the steps come to the time");
}

void check_step_count(double time, double step) {
  if (time < 0.0 || step <= 0.0) return;  // as every program refuses
  const auto steps = accepted([&] { return step_count(time, step); });
  if (steps) require_whole_steps(time, step, *steps);
}

void check_choices(const std::string& text) {
  const auto hbar = accepted([&] { return hbar_convention(text); });
  require(!hbar || name(*hbar) == text, "a convention has the name it was asked for by");
  const auto backend = accepted([&] { return backend_choice(text); });
  require(!backend || (*backend ? name(**backend) : "fastest") == text,
          "a backend has the name it was asked for by");
}

using Answer = std::variant<IntegrateRequest, int>;

std::optional<Answer> read(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "integrate");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int argc = static_cast<int>(arguments.size());
  return accepted([&] { return read_integrate_arguments(argc, argv.data()); });
}

void check_values(const IntegrateRequest& request) {
  require(2 <= request.n && request.n <= 4096, "2 <= n <= 4096");
  require(request.n >= 5 || request.modes_file, "the default modes need n >= 5");
  require(request.step > 0.0 && std::isfinite(request.step), "h is positive and finite");
  require(request.time >= 0.0 && std::isfinite(request.time), "T is finite, and not negative");
  require_whole_steps(request.time, request.step, request.steps);
  const SolverOptions& solver = request.solver;
  require(solver.tolerance >= 1e-15 && std::isfinite(solver.tolerance), "1e-15 <= tolerance");
  require(1 <= solver.max_sweeps && solver.max_sweeps <= 1000000, "1 <= sweeps <= 1000000");
  require(static_cast<bool>(request.integrator.make), "the integrator can be made");
  const int stages = request.integrator.stages;
  require(1 <= stages && stages <= max_stages, "1 <= s <= 20");
  if (request.formulation) {
    require(request.integrator.name == fmt::format("{}{}", name(*request.formulation), stages),
            "the integrator is the one asked for");
  }
}

// A command line that asks for the same, every value as the program holds it.
std::vector<std::string> written_out(const IntegrateRequest& request) {
  std::vector<std::string> arguments = {
      fmt::format("--n={}", request.n),
      fmt::format("--step={}", request.step),
      fmt::format("--time={}", request.time),
      fmt::format("--tolerance={}", request.solver.tolerance),
      fmt::format("--max-sweeps={}", request.solver.max_sweeps),
      fmt::format("--hbar={}", name(request.hbar)),
      fmt::format("--products={}", request.products ? name(*request.products) : "fastest"),
  };
  if (request.formulation) {
    arguments.push_back(fmt::format("--formulation={}", name(*request.formulation)));
    arguments.push_back(fmt::format("--stages={}", request.integrator.stages));
  } else {
    arguments.push_back(fmt::format("--integrator={}", request.integrator.name));
  }
  const auto add_file = [&](const char* option, const std::optional<std::string>& file) {
    if (!file) return;
    if (file->empty()) {  // --option= is refused
      arguments.emplace_back(option);
      arguments.emplace_back();
    } else {
      arguments.push_back(fmt::format("{}={}", option, *file));
    }
  };
  add_file("--modes", request.modes_file);
  add_file("--output", request.output_file);
  if (request.json) arguments.emplace_back("--json");
  return arguments;
}

void check_command_line(const std::vector<std::string>& arguments) {
  const std::optional<Answer> answer = read(arguments);
  if (!answer) return;
  if (const int* exit_code = std::get_if<int>(&*answer)) {
    require(*exit_code == exit_done, "help is no failure");
    return;
  }
  const auto& request = std::get<IntegrateRequest>(*answer);
  check_values(request);
  const std::vector<std::string> written = written_out(request);
  const std::optional<Answer> again = read(written);
  require(again && std::holds_alternative<IntegrateRequest>(*again), "what it asks for is allowed");
  const auto& same = std::get<IntegrateRequest>(*again);
  require(written_out(same) == written && same.steps == request.steps,
          "a command line written out asks for the same");
}

}  // namespace

void check(std::string_view text) {
  const std::vector<std::string> lines = lines_of(text);
  std::optional<double> before;
  for (const std::string& line : lines) {
    check_whole_number(line);
    check_choices(line);
    const std::optional<double> number = check_real_number(line);
    if (before && number) check_step_count(*before, *number);
    before = number;
  }
  check_command_line(lines);
}

}  // namespace isosyrk::fuzzing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isosyrk::fuzzing::check({reinterpret_cast<const char*>(data), size});
  return 0;
}
