#include "benchmarks/integrate/series.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "benchmarks/program.h"
#include "isosyrk/linalg/byte_hash.h"

namespace isosyrk {

namespace fs = std::filesystem;

SeriesFile::SeriesFile(const std::string& path, const std::optional<std::string>& to_be_made)
    : path_(path) {
  if (path.empty()) fail("empty; must name a file");
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_regular_file(path_)) fail("not a plain file; must name a file");
    if (access(path_.c_str(), R_OK | W_OK) != 0) fail(std::strerror(errno));
  }
  const fs::path folder = fs::absolute(path_).lexically_normal().parent_path();
  const bool will_be_there =
      to_be_made && (fs::absolute(*to_be_made) / path_.filename()).lexically_normal() ==
                        folder / path_.filename();
  if (!will_be_there && access(folder.c_str(), W_OK | X_OK) != 0) {
    fail(fmt::format("cannot be written ({})", std::strerror(errno)));
  }
  if (error) fail(error.message());
  position_.hash = hash_of_nothing;
}

SeriesFile::~SeriesFile() {
  if (file_ >= 0) close(file_);
}

void SeriesFile::fail(const std::string& why) const {
  throw BadArgument(fmt::format("--series {}: {}", path_.string(), why));
}

void SeriesFile::begin() {
  file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) fail(fmt::format("cannot be written ({})", std::strerror(errno)));
  write("t,energy,spectrum_error,enstrophy,sweeps,seconds\n");
}

void SeriesFile::resume(const Position& position) {
  std::ifstream input(path_, std::ios::binary);
  std::string piece(std::size_t{1} << 16U, '\0');
  Position found{.bytes = 0, .hash = hash_of_nothing};
  while (input && found.bytes < position.bytes) {
    const std::uint64_t wanted =
        std::min<std::uint64_t>(piece.size(), position.bytes - found.bytes);
    input.read(piece.data(), static_cast<std::streamsize>(wanted));
    const auto count = static_cast<std::size_t>(input.gcount());
    found.hash = hash_after(found.hash, piece.data(), count);
    found.bytes += count;
  }
  if (found.bytes != position.bytes || found.hash != position.hash) {
    fail("does not begin as the series of the run that --resume goes on with");
  }
  file_ = open(path_.c_str(), O_RDWR | O_CLOEXEC);
  const auto length = static_cast<off_t>(position.bytes);
  if (file_ < 0 || ftruncate(file_, length) != 0 || lseek(file_, length, SEEK_SET) != length) {
    fail(fmt::format("cannot be written ({})", std::strerror(errno)));
  }
  position_ = position;
}

// Without a buffer, so that a row is there once it is written.
void SeriesFile::write(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(file_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const std::string why = std::strerror(count < 0 ? errno : ENOSPC);
      const bool is_cut = ftruncate(file_, static_cast<off_t>(position_.bytes)) == 0;
      fail(fmt::format("cannot be written ({}){}", why, is_cut ? "" : "; its last row is none"));
    }
    done += static_cast<std::size_t>(count);
  }
  position_.bytes += line.size();
  position_.hash = hash_after(position_.hash, line.data(), line.size());
}

void SeriesFile::append(const SeriesRow& row) {
  write(fmt::format("{},{},{},{},{},{}\n", row.t, row.energy, row.spectrum_error, row.enstrophy,
                    row.sweeps, row.seconds));
}

}  // namespace isosyrk
