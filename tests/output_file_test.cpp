#include "benchmarks/output_file.h"

#include <fstream>
#include <iterator>

#include <unistd.h>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public WithFolder {
 protected:
  static std::string contents(const fs::path& path) {
    std::ifstream input(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(input), {}};
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const fs::path path_ = folder_ / "W.npy";
};

TEST_F(OutputFiles, AreWrittenBesideWhatAKilledProgramLeft) {
  const OutputFile killed("--output", path_.string());
  std::ofstream(killed.temporary_path()) << "half";
  // Nor does a name in the way that this process could have chosen by its number.
  fs::create_directory(folder_ / ("W.npy." + std::to_string(getpid()) + ".partial"));
  OutputFile("--output", path_.string()).write("new");
  EXPECT_EQ(contents(path_), "new");
  EXPECT_EQ(files(), 3U);
}

TEST_F(OutputFiles, GoThroughASymbolicLinkWithoutReplacingIt) {
  write("real", "old");
  fs::create_symlink(folder_ / "real", folder_ / "link");
  OutputFile("--output", (folder_ / "link").string()).write("new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(contents(folder_ / "real"), "new");
}

}  // namespace
}  // namespace isosyrk::testing
