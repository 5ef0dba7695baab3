#include "benchmarks/benchmark_program.h"

#include <fmt/format.h>

#include <optional>

#include "benchmarks/arguments.h"
#include "benchmarks/output_file.h"

namespace isosyrk {
namespace {

int failed_rows = 0;

std::string prefix(const std::string& flag) { return fmt::format("--benchmark_{}=", flag); }

}  // namespace

void fail_row(benchmark::State& state, const std::string& why) {
  ++failed_rows;
  state.SkipWithError(why.c_str());
}

std::string benchmark_flag(const std::vector<std::string>& arguments, const std::string& flag,
                           const std::string& fallback) {
  std::string value = fallback;
  for (const std::string& argument : arguments) {
    if (argument.starts_with(prefix(flag))) value = argument.substr(prefix(flag).size());
  }
  return value;
}

int run_benchmarks(std::vector<std::string> arguments, const Conditions& conditions) {
  std::optional<OutputFile> output;
  for (std::string& argument : arguments) {
    if (argument.starts_with(prefix("out"))) {
      output.emplace("--benchmark_out", argument.substr(prefix("out").size()));
      argument = prefix("out") + output->temporary_path();
    }
  }
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  if (argc > 1) throw BadArgument(fmt::format("'{}': not an argument of this program", argv[1]));

  for (const auto& [key, value] : conditions) benchmark::AddCustomContext(key, value);
  const std::size_t matched = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  if (matched == 0) {
    if (output) output->discard();
    throw BadArgument(fmt::format("--benchmark_filter={}: matches no benchmark",
                                  benchmark_flag(arguments, "filter", "")));
  }
  if (output && benchmark_flag(arguments, "list_tests", "false") == "false") output->commit();
  return failed_rows == 0 ? exit_done : exit_solver_failed;
}

}  // namespace isosyrk
