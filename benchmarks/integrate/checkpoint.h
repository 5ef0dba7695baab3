// The file from which a run goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// What a checkpoint says before the state: a line of JSON.
struct CheckpointHeader {
  long step = 0;                   ///< after which it was written
  nlohmann::ordered_json command;  ///< what the run was asked for, an object
};

/// Passes the state of a run to an archive, or takes it from there.
using ArchiveRun = std::function<void(StateArchive&)>;

/// Replaces the checkpoint at `path`.  Throws BadArgument, naming --snapshots, if it cannot be
/// written; an earlier one is then as it was.
void write_checkpoint(const std::filesystem::path& path, const CheckpointHeader& header,
                      const ArchiveRun& archive);

/// A checkpoint that was written, by any run.
class Checkpoint {
 public:
  /// Reads the header, and all bytes once.  Throws BadArgument, naming --resume, if there is no
  /// checkpoint, or it is not whole.
  explicit Checkpoint(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  const CheckpointHeader& header() const { return header_; }
  /// Reads the state.  Throws BadArgument if it is not of such a run.
  void read(const ArchiveRun& archive) const;

  /// Throws BadArgument, naming --resume, the file and why it cannot be used.
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::filesystem::path path_;
  CheckpointHeader header_;
  std::streamoff begin_ = 0;  // of the state
};

}  // namespace isosyrk
