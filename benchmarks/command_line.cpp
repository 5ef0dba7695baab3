#include "benchmarks/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

namespace isosyrk {

CommandLine::Option CommandLine::Option::required() {
  option_->required();
  return *this;
}

CommandLine::Option CommandLine::Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

CommandLine::CommandLine(const std::string& description)
    : line_(std::make_unique<CLI::App>(description)) {}

CommandLine::~CommandLine() = default;

CommandLine::Option CommandLine::add_text(const std::string& option, const std::string& description,
                                          const std::function<void(const std::string&)>& set) {
  return Option(*line_->add_option_function<std::string>(option, set, description));
}

CommandLine::Option CommandLine::add_values(const std::string& name,
                                            std::vector<std::string>& values,
                                            const std::string& description) {
  return Option(*line_->add_option(name, values, description));
}

CommandLine::Option CommandLine::add_flag(const std::string& option, bool& given,
                                          const std::string& description) {
  return Option(*line_->add_flag(option, given, description)->disable_flag_override());
}

void CommandLine::allow_extras() { line_->allow_extras(); }

std::optional<int> CommandLine::parse(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument.starts_with("--") && argument.ends_with('=')) {
      throw BadArgument(fmt::format("{}: empty; must be followed by a value", argument));
    }
  }
  try {
    line_->parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return line_->exit(help);
  } catch (const CLI::Error& error) {
    throw BadArgument(error.what());
  }
  return std::nullopt;
}

bool CommandLine::has(const std::string& option) const { return line_->count(option) > 0; }

std::string CommandLine::text(const std::string& option) const {
  return (*line_)[option]->as<std::string>();
}

std::vector<std::string> CommandLine::remaining() const { return line_->remaining(); }

}  // namespace isosyrk
