#include "benchmarks/benchmark_program.h"

#include <fmt/format.h>
#include <regex.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "benchmarks/arguments.h"

extern "C" char** environ;  // NOLINT(readability-redundant-declaration)

namespace isosyrk {
namespace {

int failed_rows = 0;

// Google Benchmark divides 0 by 0 for the coefficient of variation of a counter that is always 0,
// and prints NaN, which is not JSON.
class StrictJsonReporter final : public benchmark::JSONReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> finite = runs;
    for (Run& run : finite) {
      for (auto counter = run.counters.begin(); counter != run.counters.end();) {
        counter =
            std::isfinite(counter->second.value) ? std::next(counter) : run.counters.erase(counter);
      }
    }
    JSONReporter::ReportRuns(finite);
  }
};

// Without a warning that says how the distribution built Google Benchmark, and nothing of what is
// measured: benchmarks/README.md explains it.
class Screen final : public benchmark::ConsoleReporter {
 public:
  explicit Screen(bool tabular) : ConsoleReporter(options(tabular)) {}

  bool ReportContext(const Context& context) override {
    std::ostream& screen = GetErrorStream();
    std::stringstream said;
    SetErrorStream(&said);
    const bool goes_on = ConsoleReporter::ReportContext(context);
    SetErrorStream(&screen);
    for (std::string line; std::getline(said, line);) {
      if (line.find("Library was built as DEBUG") == std::string::npos) screen << line << '\n';
    }
    screen.flush();
    return goes_on;
  }

 private:
  static OutputOptions options(bool tabular) {
    const int color = isatty(STDOUT_FILENO) != 0 ? OO_Color : OO_None;
    return static_cast<OutputOptions>(color | (tabular ? OO_Tabular : OO_None));
  }
};

// Google Benchmark's rule: an extended regular expression found anywhere in a name; a leading '-'
// inverts it.
bool matches_any(const std::string& filter, const std::vector<std::string>& names) {
  const bool inverted = filter.starts_with('-');
  regex_t expression;
  if (regcomp(&expression, filter.c_str() + (inverted ? 1 : 0), REG_EXTENDED | REG_NOSUB) != 0) {
    throw BadArgument(
        fmt::format("--benchmark_filter={}: not a regular expression; must be one", filter));
  }
  const bool found = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return (regexec(&expression, name.c_str(), 0, nullptr, 0) == 0) != inverted;
  });
  regfree(&expression);
  return found;
}

// BENCHMARK_OUT and its like would pass by the checks of the arguments.
void clear_environment() {
  std::vector<std::string> names;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (text.starts_with("BENCHMARK_")) names.push_back(text.substr(0, text.find('=')));
  }
  for (const std::string& name : names) unsetenv(name.c_str());
}

bool is_whole_json(const std::string& path) {
  std::ifstream input(path);
  return nlohmann::ordered_json::accept(input);
}

}  // namespace

void fail_row(benchmark::State& state, const std::string& why) {
  ++failed_rows;
  state.SkipWithError(why.c_str());
}

bool BenchmarkArguments::selects_any(const std::vector<std::string>& names) const {
  return filter.empty() || matches_any(filter, names);
}

BenchmarkArguments read_benchmark_arguments(const std::vector<std::string>& given,
                                            const std::vector<std::string>& names) {
  const std::string prefix = "--benchmark_";
  BenchmarkArguments read;
  for (const std::string& argument : given) {
    const auto equals = argument.find('=');
    const std::string option = argument.substr(0, equals);
    const std::string value = equals == std::string::npos ? "true" : argument.substr(equals + 1);
    const auto is = [&](const std::string& flag) { return option == prefix + flag; };
    if (is("out")) {
      read.output.emplace(option, value);
      read.passed_on.push_back(fmt::format("{}={}", option, read.output->temporary_path()));
      continue;
    }
    if (is("filter")) {
      if (!matches_any(value, names)) {
        throw BadArgument(fmt::format("{}={}: matches no benchmark; names are like {}", option,
                                      value, names.front()));
      }
      read.filter = value;
    } else if (is("repetitions")) {
      read.repetitions = whole_number(option, value, 1, 1000);
    } else if (is("min_time")) {
      real_number(option, value, "positive seconds, at most 3600", positive, 3600.0);
    } else if (is("enable_random_interleaving") || is("report_aggregates_only") ||
               is("display_aggregates_only") || is("counters_tabular") || is("list_tests")) {
      if (value != "true" && value != "false") {
        throw BadArgument(fmt::format("{} '{}': must be true or false", option, value));
      }
    } else {
      throw BadArgument(
          fmt::format("'{}': not an argument of this program (see --help)", argument));
    }
    read.passed_on.push_back(fmt::format("{}={}", option, value));
  }
  return read;
}

int run_benchmarks(const std::string& program, const BenchmarkArguments& arguments,
                   const Conditions& conditions) {
  clear_environment();
  const std::optional<OutputFile>& output = arguments.output;
  std::vector<std::string> passed_on = {program, "--benchmark_out_format=json"};
  passed_on.insert(passed_on.end(), arguments.passed_on.begin(), arguments.passed_on.end());
  std::vector<char*> argv;
  for (std::string& argument : passed_on) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());

  for (const auto& [key, value] : conditions) benchmark::AddCustomContext(key, value);
  const auto is_given = [&](const std::string& argument) {
    return std::find(passed_on.begin(), passed_on.end(), argument) != passed_on.end();
  };
  StrictJsonReporter json;
  Screen screen(is_given("--benchmark_counters_tabular=true"));
  // Without --benchmark_out Google Benchmark refuses a reporter for the file.
  benchmark::RunSpecifiedBenchmarks(&screen, output ? &json : nullptr);
  benchmark::Shutdown();
  if (output) {
    if (is_given("--benchmark_list_tests=true")) {
      output->discard();
    } else if (!is_whole_json(output->temporary_path())) {
      output->discard();
      throw BadArgument(fmt::format(
          "--benchmark_out {}: could not be written whole; is the disk full?", output->path()));
    } else {
      output->commit();
    }
  }
  std::cout.flush();
  require_printed();
  return failed_rows == 0 ? exit_done : exit_solver_failed;
}

}  // namespace isosyrk
