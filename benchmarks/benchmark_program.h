// What our Google Benchmark programs share around RunSpecifiedBenchmarks.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "benchmarks/conditions.h"

namespace isosyrk {

/// Marks the row as failed, in Google Benchmark's report and for the program's exit code, which
/// Google Benchmark alone would leave at 0.
void fail_row(benchmark::State& state, const std::string& why);

/// Runs the registered benchmarks with Google Benchmark's own `arguments` (program name first) and
/// returns the exit code: exit_bad_arguments for an argument that is not known, an output that
/// cannot be written or a filter that matches nothing; exit_solver_failed if a row failed.
/// --benchmark_out is written to a temporary neighbour and renamed at the end.
/// Throws BadArgument.
int run_benchmarks(std::vector<std::string> arguments, const Conditions& conditions);

/// The value of Google Benchmark's `--benchmark_<flag>=value` in the arguments, or `fallback`.
std::string benchmark_flag(const std::vector<std::string>& arguments, const std::string& flag,
                           const std::string& fallback);

}  // namespace isosyrk
