// What our Google Benchmark programs share around RunSpecifiedBenchmarks.
#pragma once

#include <benchmark/benchmark.h>

#include <optional>
#include <string>
#include <vector>

#include "benchmarks/conditions.h"
#include "benchmarks/output_file.h"

namespace isosyrk {

/// Marks the row as failed, in Google Benchmark's report and for the program's exit code, which
/// Google Benchmark alone would leave at 0.
void fail_row(benchmark::State& state, const std::string& why);

/// Those of Google Benchmark's arguments that our programs take, checked: what it finds wrong
/// itself it reports in other words, other exit codes, or not at all.
struct BenchmarkArguments {
  std::vector<std::string> passed_on;  ///< to Google Benchmark
  std::string filter;                  ///< empty for all benchmarks
  std::optional<OutputFile> output;
  long repetitions = 1;

  /// Whether the filter leaves any of these names in.
  bool selects_any(const std::vector<std::string>& names) const;
};

/// `given` are arguments such as --benchmark_filter=n:17/, `names` those of all benchmarks of the
/// program.  Throws BadArgument for an argument or value that is not known, a filter that matches
/// none of the names, and an output that cannot be written.
BenchmarkArguments read_benchmark_arguments(const std::vector<std::string>& given,
                                            const std::vector<std::string>& names);

/// Runs the registered benchmarks and returns the exit code: exit_solver_failed if a row failed.
/// --benchmark_out is written to a temporary neighbour and renamed when it is whole.
/// Throws BadArgument.
int run_benchmarks(const std::string& program, const BenchmarkArguments& arguments,
                   const Conditions& conditions);

}  // namespace isosyrk
