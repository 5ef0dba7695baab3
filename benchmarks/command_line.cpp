#include "benchmarks/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "benchmarks/program.h"

namespace isosyrk {

struct CommandLine::Parser {
  explicit Parser(const std::string& description) : app(description) {}
  CLI::App app;
};

CommandLine::CommandLine(const std::string& description)
    : parser_(std::make_unique<Parser>(description)) {}
CommandLine::~CommandLine() = default;

void CommandLine::option(const std::string& name, std::string& value, const std::string& help,
                         Need need) {
  parser_->app.add_option(name, value, help)->required(need == Need::required);
}

void CommandLine::option(const std::string& name, std::vector<std::string>& values,
                         const std::string& help, Need need) {
  parser_->app.add_option(name, values, help)->required(need == Need::required);
}

void CommandLine::flag(const std::string& name, bool& value, const std::string& help) {
  parser_->app.add_flag(name, value, help)->disable_flag_override();
}

void CommandLine::allow_others() { parser_->app.allow_extras(); }

std::optional<int> CommandLine::read(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument.starts_with("--") && argument.ends_with('=')) {
      throw BadArgument(fmt::format("{}: empty; must be followed by a value", argument));
    }
  }
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return parser_->app.exit(help);
  } catch (const CLI::Error& error) {
    throw BadArgument(error.what());
  }
  return std::nullopt;
}

bool CommandLine::given(const std::string& name) const { return parser_->app.count(name) > 0; }

std::vector<std::string> CommandLine::others() const { return parser_->app.remaining(); }

}  // namespace isosyrk
