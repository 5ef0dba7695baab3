#include "benchmarks/integrate/snapshots.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>
#include <regex>

#include "benchmarks/integrate/whole_file.h"
#include "benchmarks/npy_file.h"
#include "benchmarks/program.h"

namespace isosyrk {

namespace fs = std::filesystem;

SnapshotFolder::SnapshotFolder(const std::string& path) : path_(path) {
  if (path.empty()) fail("empty; must name a folder");
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_)) fail("not a folder");
    if (access(path_.c_str(), W_OK | X_OK) != 0) fail(std::strerror(errno));
    lock();
    return;
  }
  if (error) fail(error.message());
  const fs::path above = fs::absolute(path_ / "..").lexically_normal();
  if (access(above.c_str(), W_OK | X_OK) != 0) {
    fail(fmt::format("cannot be made ({})", std::strerror(errno)));
  }
}

SnapshotFolder::~SnapshotFolder() {
  if (lock_ >= 0) close(lock_);
}

void SnapshotFolder::fail(const std::string& why) const {
  throw BadArgument(fmt::format("--snapshots {}: {}", path_.string(), why));
}

// The lock goes with the process, however that ends.
void SnapshotFolder::lock() {
  lock_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail(std::strerror(errno));
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    fail("another process writes there");
  }
}

bool SnapshotFolder::holds_a_run() const {
  if (lock_ < 0) return false;
  if (fs::exists(checkpoint())) return true;
  static const std::regex snapshot(R"(W_\d{10,}\.npy)");
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (std::regex_match(entry.path().filename().string(), snapshot)) return true;
  }
  return false;
}

void SnapshotFolder::make() {
  if (lock_ >= 0) return;
  std::error_code error;
  fs::create_directory(path_, error);
  if (error) fail(fmt::format("cannot be made ({})", error.message()));
  lock();
}

void SnapshotFolder::write(long step, const Matrix& W) const {
  const fs::path file = path_ / fmt::format("W_{:010}.npy", step);
  replace_whole_file("--snapshots", file, [&](std::ostream& output) {
    const std::string contents = npy(W);
    output.write(contents.data(), static_cast<std::streamsize>(contents.size()));
  });
}

}  // namespace isosyrk
