// Reading initial modes from a file.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "isosyrk/scenes/modes.h"

namespace isosyrk {

/// Reads modes from CSV: a header line naming the columns l, m, re and im, in any order, then a
/// line a mode.  Each mode must be valid by core's require_valid_mode.  Throws
/// std::invalid_argument naming `source` and the line.
std::vector<Mode> read_modes(std::istream& input, const std::string& source, Index n);

/// Reads the file at `path`; its modes must be valid together, too.  Throws std::invalid_argument.
std::vector<Mode> read_modes_file(const std::string& path, Index n);

}  // namespace isosyrk
