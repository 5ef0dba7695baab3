#include "benchmarks/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "benchmarks/program.h"

namespace isosyrk {

namespace fs = std::filesystem;

OutputFile::OutputFile(std::string option, const std::string& path)
    : option_(std::move(option)), shown_(path) {
  if (path.empty()) fail("empty; must name a file");
  std::error_code error;
  // Through a symbolic link the file it points to is replaced, not the link.
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) fail(error.message());
  if (fs::exists(target) && !fs::is_regular_file(target)) {
    fail("not a plain file; must name a file");
  }
  if (fs::exists(target) && access(target.c_str(), W_OK) != 0) fail(std::strerror(errno));
  path_ = target.string();
  const std::string suffix = ".partial";
  temporary_ = path_ + ".XXXXXX" + suffix;
  const int probe = mkstemps(temporary_.data(), static_cast<int>(suffix.size()));
  if (probe < 0) fail(fmt::format("cannot be written ({})", std::strerror(errno)));
  close(probe);
  fs::remove(temporary_, error);
}

void OutputFile::fail(const std::string& why) const {
  throw BadArgument(fmt::format("{} {}: {}", option_, shown_, why));
}

void OutputFile::commit() const {
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) {
    discard();
    fail(fmt::format("cannot be written ({})", error.message()));
  }
}

void OutputFile::discard() const {
  std::error_code error;
  fs::remove(temporary_, error);
}

void OutputFile::write(const std::string& contents) const {
  {
    std::ofstream output(temporary_, std::ios::binary);
    output.write(contents.data(), static_cast<std::streamsize>(contents.size()));
    output.close();
    if (!output) {
      const std::string why = std::strerror(errno);
      discard();
      fail(fmt::format("cannot be written ({})", why));
    }
  }
  commit();
}

}  // namespace isosyrk
