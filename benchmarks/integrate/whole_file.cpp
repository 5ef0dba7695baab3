#include "benchmarks/integrate/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "benchmarks/program.h"

namespace isosyrk {

void send_to_disk(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  fsync(file);
  close(file);
}

void replace_whole_file(const std::string& option, const std::filesystem::path& path,
                        const std::function<void(std::ostream&)>& write) {
  const std::filesystem::path partial = path.string() + ".partial";
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw BadArgument(fmt::format("{} {}: cannot be written ({})", option, path.string(), why));
  };
  errno = 0;
  std::ofstream output(partial, std::ios::binary);
  try {
    if (output) write(output);
  } catch (const std::ios_base::failure&) {  // as a StateWriter says it
  }
  output.close();
  if (!output) fail(std::strerror(errno));
  send_to_disk(partial);
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error) fail(error.message());
  send_to_disk(path.parent_path());
}

}  // namespace isosyrk
