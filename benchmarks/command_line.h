// The options of a program, declared one by one and read by CLI11.  Behind a pointer, because that
// library's header costs every source that sees it five seconds to compile.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isosyrk {

class CommandLine {
 public:
  enum class Need { optional, required };

  explicit CommandLine(const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Declares an option with one value, or with several.  `name` as it is typed, such as "--n", or
  /// a bare word for what stands without one.  `value` is kept where it is not given, and must
  /// outlive this.
  void option(const std::string& name, std::string& value, const std::string& help,
              Need need = Need::optional);
  void option(const std::string& name, std::vector<std::string>& values, const std::string& help,
              Need need = Need::optional);
  /// Declares an option without a value.
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Leaves arguments that were not declared to others().
  void allow_others();

  /// Reads the arguments into what was declared; an exit code if that was all, as for --help.
  /// Throws BadArgument, also for an option given as `--option=` with nothing behind, where CLI11
  /// would take the next argument for its value.
  std::optional<int> read(int argc, char** argv);

  /// Whether a declared option was given.
  bool given(const std::string& name) const;
  /// The arguments that were not declared.
  std::vector<std::string> others() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace isosyrk
