// Reading a command line with CLI11, whose header is precompiled: it takes five seconds.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace isosyrk {

/// Reads the arguments into the options declared in `line`; an exit code if that was all, as for
/// --help.  Throws BadArgument, also for an option given as `--option=` with nothing behind, where
/// CLI11 would take the next argument for its value.
std::optional<int> read_arguments(CLI::App& line, int argc, char** argv);

}  // namespace isosyrk
