// The folder of a long run: W every so many steps, and the checkpoint.
#pragma once

#include <filesystem>
#include <string>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The folder that --snapshots names, of one run and of one process at a time.  It has the files
/// W_0000000000.npy, the digits being the step, and `checkpoint`.  Other files in it are let be.
class SnapshotFolder {
 public:
  /// Takes the folder if it is there, and makes none.  Throws BadArgument if it cannot be written,
  /// or if another process has it.
  explicit SnapshotFolder(const std::string& path);
  ~SnapshotFolder();
  SnapshotFolder(const SnapshotFolder&) = delete;
  SnapshotFolder& operator=(const SnapshotFolder&) = delete;

  /// Returns whether the folder has a file of a run.
  bool holds_a_run() const;
  /// Makes the folder if it is not there, and takes it.  Throws BadArgument.
  void make();

  /// Writes W, n x n, after this many steps.  Throws BadArgument; the file is whole or is not
  /// there.
  void write(long step, const Matrix& W) const;
  std::filesystem::path checkpoint() const { return path_ / "checkpoint"; }

 private:
  [[noreturn]] void fail(const std::string& why) const;
  void lock();

  std::filesystem::path path_;
  int lock_ = -1;  // file descriptor of the folder
};

}  // namespace isosyrk
