// Reading a command line with CLI11, whose header is precompiled: it takes five seconds.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "benchmarks/arguments.h"

namespace isosyrk {

/// Reads the arguments into the options declared in `line`; an exit code if that was all, as for
/// --help.  Throws BadArgument, also for an option given as `--option=` with nothing behind, where
/// CLI11 would take the next argument for its value.
std::optional<int> read_arguments(CLI::App& line, int argc, char** argv);

/// Declares an option whose value is what `read(option, text)` returns, and which keeps `value` if
/// it is not given.  CLI11's own reading of numbers and names takes other spellings too, and says
/// otherwise what is wrong with a value.
template <class Value, class Read>
CLI::Option* add_value(CLI::App& line, const std::string& option, Value& value, Read read,
                       const std::string& description) {
  const auto set = [option, &value, read](const std::string& text) { value = read(option, text); };
  return line.add_option_function<std::string>(option, set, description);
}

// What reads a value: one of the following.  Each throws BadArgument.

/// A whole number in [least, most].
template <class Integer>
struct Whole {
  long least;
  long most;
  Integer operator()(const std::string& option, const std::string& text) const {
    return static_cast<Integer>(whole_number(option, text, least, most));
  }
};

/// A finite real number of at least `least`, which `allowed` says in words.
struct Real {
  const char* allowed;
  double least = std::numeric_limits<double>::lowest();
  double operator()(const std::string& option, const std::string& text) const {
    return real_number(option, text, allowed, least);
  }
};

/// A name that `from_name` takes; otherwise that throws std::invalid_argument as of_option wants
/// it.
template <class FromName>
struct Named {
  FromName* from_name;
  auto operator()(const std::string&, const std::string& text) const {
    return of_option([&] { return from_name(text); });
  }
};
template <class FromName>
Named(FromName*) -> Named<FromName>;

/// Any text.
struct Text {
  std::string operator()(const std::string&, const std::string& text) const { return text; }
};

}  // namespace isosyrk
