// Reading a command line with CLI11, which only command_line.cpp includes: its functions, all of
// them in headers, take ten seconds to compile in each source that does.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/arguments.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace isosyrk {

/// The options of a program, declared one by one, and then what its arguments give.
class CommandLine {
 public:
  /// An option that is declared.
  class Option {
   public:
    explicit Option(CLI::Option& option) : option_(&option) {}
    Option required();
    /// How --help names the value, in place of TEXT.
    Option type_name(const std::string& name);

   private:
    CLI::Option* option_;
  };

  /// `description` stands first in --help.
  explicit CommandLine(const std::string& description);
  ~CommandLine();

  /// Declares an option whose value is what `read(option, text)` returns, and which keeps `value`
  /// if it is not given.  CLI11's own reading of numbers and names takes other spellings too, and
  /// says otherwise what is wrong with a value.
  template <class Value, class Read>
  Option add_value(const std::string& option, Value& value, Read read,
                   const std::string& description) {
    return add_text(option, description, [option, &value, read](const std::string& text) {
      value = read(option, text);
    });
  }

  /// Declares an option of one or more values or, by a name without dashes, the arguments that
  /// belong to no option.
  Option add_values(const std::string& name, std::vector<std::string>& values,
                    const std::string& description);

  /// Declares an option without a value.
  Option add_flag(const std::string& option, bool& given, const std::string& description);

  /// Arguments that are not declared are no mistake, but left for remaining().
  void allow_extras();

  /// Reads the arguments; an exit code if that was all, as for --help.  Throws BadArgument, also
  /// for an option given as `--option=` with nothing behind, where CLI11 would take the next
  /// argument for its value.
  std::optional<int> parse(int argc, char** argv);

  /// Whether an option was given.
  bool has(const std::string& option) const;
  /// What an option was given, as it was written.
  std::string text(const std::string& option) const;
  std::vector<std::string> remaining() const;

 private:
  Option add_text(const std::string& option, const std::string& description,
                  const std::function<void(const std::string&)>& set);

  std::unique_ptr<CLI::App> line_;
};

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
