#include "benchmarks/output_file.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include <sys/wait.h>
#include <unistd.h>

#include "benchmarks/arguments.h"
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

TEST_F(OutputFiles, AppearOnlyWhenCompleteAndKeepTheEarlierOneUntilThen) {
  const OutputFile output("--output", path_.string());
  EXPECT_EQ(files(), 0U);  // the check leaves nothing behind
  output.write("old");
  const OutputFile next("--output", path_.string());
  EXPECT_EQ(contents(path_), "old");
  next.discard();
  EXPECT_EQ(contents(path_), "old");
  next.write("new");
  EXPECT_EQ(contents(path_), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputFiles, AreWrittenBesideWhatAKilledProgramLeft) {
  const pid_t killed = fork();
  if (killed == 0) {
    const OutputFile output("--output", path_.string());
    std::ofstream(output.temporary_path()) << "half" << std::flush;
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(killed, &status, 0), killed);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(files(), 1U);
  // Nor does a name in the way that this process could have chosen by its number.
  fs::create_directory(folder_ / ("W.npy." + std::to_string(getpid()) + ".partial"));
  OutputFile("--output", path_.string()).write("new");
  EXPECT_EQ(contents(path_), "new");
  EXPECT_EQ(files(), 3U);
}

TEST_F(OutputFiles, OfTheSameNameAreWrittenAtOnceWithoutMixing) {
  const OutputFile one("--output", path_.string());
  const OutputFile other("--output", path_.string());
  EXPECT_NE(one.temporary_path(), other.temporary_path());
}

TEST_F(OutputFiles, GoThroughASymbolicLinkWithoutReplacingIt) {
  write("real", "old");
  fs::create_symlink(folder_ / "real", folder_ / "link");
  OutputFile("--output", (folder_ / "link").string()).write("new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(contents(folder_ / "real"), "new");
}

TEST_F(OutputFiles, ThatCannotBeWrittenAreRefusedAtOnce) {
  EXPECT_THROW(OutputFile("--output", ""), BadArgument);
  EXPECT_THROW(OutputFile("--output", folder_.string()), BadArgument);
  EXPECT_THROW(OutputFile("--output", (folder_ / "no" / "W.npy").string()), BadArgument);
  EXPECT_THROW(OutputFile("--output", "/dev/null"), BadArgument);
  write("file", "x");
  EXPECT_THROW(OutputFile("--output", (folder_ / "file" / "W.npy").string()), BadArgument);
  EXPECT_EQ(files(), 1U);
}

}  // namespace
}  // namespace isosyrk::testing
