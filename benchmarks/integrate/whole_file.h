// Files that are whole at any moment, whatever ends the program or the machine.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

namespace isosyrk {

/// Replaces the file at `path` by what `write` puts into a stream: written beside it as
/// NAME.partial, sent to the disk, then renamed.  What a killed program left of that neighbour is
/// overwritten.  Throws BadArgument, which names the option and the path, where that fails; an
/// earlier file is then as it was.
void replace_whole_file(const std::string& option, const std::filesystem::path& path,
                        const std::function<void(std::ostream&)>& write);

/// Sends what was written to a file, or the names in a folder, to the disk.  A file system that
/// cannot is taken at its word.
void send_to_disk(const std::filesystem::path& path);

}  // namespace isosyrk
