// Writing result files whole or not at all.
#pragma once

#include <string>

namespace isosyrk {

/// A file to be written later: checked now, written to a temporary neighbour and renamed then, so
/// that an earlier file of that name stays until the new one is complete.  The neighbour's name is
/// one that no file has, so that what a killed program left behind is in nobody's way.
class OutputFile {
 public:
  /// Throws BadArgument if `path` could not be written (missing folder, no permission, something
  /// that is not a plain file).  Leaves nothing behind.
  OutputFile(std::string option, const std::string& path);

  /// As the user named it.
  const std::string& path() const { return shown_; }
  /// Where to write first.
  const std::string& temporary_path() const { return temporary_; }
  /// Moves what was written at temporary_path() into place.  Throws BadArgument.
  void commit() const;
  /// Removes what was written at temporary_path(), if anything.
  void discard() const;
  /// Writes `contents` and commits.  Throws BadArgument, leaving no part of it.
  void write(const std::string& contents) const;

 private:
  [[noreturn]] void fail(const std::string& why) const;

  std::string option_;
  std::string shown_;
  std::string path_;
  std::string temporary_;
};

}  // namespace isosyrk
