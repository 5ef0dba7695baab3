// The numbers of a long run, a row every so many steps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "isosyrk/linalg/state_archive.h"

namespace isosyrk {

/// A row of a series.
struct SeriesRow {
  double t = 0.0;
  double energy = 0.0;          ///< H(W)
  double spectrum_error = 0.0;  ///< largest |λ_k(W) - λ_k(W₀)|
  double enstrophy = 0.0;       ///< ½ ‖W‖_F²
  long sweeps = 0;              ///< since t = 0
  double seconds = 0.0;         ///< CPU time of the steps since t = 0
};

/// The CSV file that --series names: a header, and whole rows at any moment.
class SeriesFile {
 public:
  /// How far a file has come: its bytes, and a hash of them.
  struct Position {
    std::uint64_t bytes = 0;
    std::uint64_t hash = 0;
    void archive(StateArchive& state) { state.pass(bytes, hash); }
  };

  /// Throws BadArgument if `path` could not be written once there is the folder `to_be_made`. Makes
  /// no file.
  explicit SeriesFile(const std::string& path,
                      const std::optional<std::string>& to_be_made = std::nullopt);
  ~SeriesFile();
  SeriesFile(const SeriesFile&) = delete;
  SeriesFile& operator=(const SeriesFile&) = delete;

  bool exists() const { return std::filesystem::exists(path_); }
  /// Makes the file, with its header.  Throws BadArgument, also if it is there.
  void begin();
  /// Goes on from a position: cuts what came after it.  Throws BadArgument, with the file as it
  /// was, if that does not begin as the one that had this position.
  void resume(const Position& position);
  /// Appends a row.  Throws BadArgument, leaving whole rows.
  void append(const SeriesRow& row);

  const Position& position() const { return position_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(const std::string& why) const;
  void write(const std::string& line);

  std::filesystem::path path_;
  int file_ = -1;
  Position position_;
};

}  // namespace isosyrk
