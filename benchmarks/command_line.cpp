#include "benchmarks/command_line.h"

#include <fmt/format.h>

#include "benchmarks/program.h"

namespace isosyrk {

std::optional<int> read_arguments(CLI::App& line, int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument.starts_with("--") && argument.ends_with('=')) {
      throw BadArgument(fmt::format("{}: empty; must be followed by a value", argument));
    }
  }
  try {
    line.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return line.exit(help);
  } catch (const CLI::Error& error) {
    throw BadArgument(error.what());
  }
  return std::nullopt;
}

}  // namespace isosyrk
