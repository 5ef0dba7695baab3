// What the fuzzers share: a property that does not hold ends them at the input that shows it.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "benchmarks/arguments.h"

namespace isosyrk::fuzzing {

inline void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", property);
  std::abort();
}

/// What `read` returns, or nothing where it refuses its input by one of the exceptions that
/// programs turn into a line.  Any other exception ends the fuzzer.
template <class Read>
auto accepted(Read&& read) -> std::optional<decltype(read())> {
  const auto check_line = [](std::string_view line) {
    require(!line.empty(), "a refusal says why");
    require(line.find('\n') == std::string_view::npos, "a refusal is one line");
  };
  try {
    return read();
  } catch (const BadArgument& refusal) {
    check_line(refusal.what());
  } catch (const std::invalid_argument& refusal) {
    check_line(refusal.what());
  }
  return std::nullopt;
}

}  // namespace isosyrk::fuzzing
