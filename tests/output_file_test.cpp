#include "benchmarks/output_file.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sys/wait.h>
#include <unistd.h>

#include "benchmarks/arguments.h"

namespace isosyrk::testing {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("isosyrk_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string contents(const fs::path& path) {
    std::ifstream input(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(input), {}};
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(OutputFiles, AppearOnlyWhenComplete) {
  const fs::path path = folder_ / "W.npy";
  const OutputFile output("--output", path.string());
  EXPECT_EQ(files(), 0U);  // the check leaves nothing behind
  output.write("new");
  EXPECT_EQ(contents(path), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputFiles, KeepTheEarlierFileUntilThen) {
  const fs::path path = folder_ / "W.npy";
  std::ofstream(path) << "old";
  const OutputFile output("--output", path.string());
  EXPECT_EQ(contents(path), "old");
  output.discard();
  EXPECT_EQ(contents(path), "old");
  output.write("new");
  EXPECT_EQ(contents(path), "new");
}

TEST_F(OutputFiles, AreWrittenBesideWhatAKilledProgramLeft) {
  const fs::path path = folder_ / "W.npy";
  const pid_t killed = fork();
  if (killed == 0) {
    const OutputFile output("--output", path.string());
    std::ofstream(output.temporary_path()) << "half" << std::flush;
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(killed, &status, 0), killed);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(files(), 1U);
  // Nor does a name in the way that this process could have chosen by its number.
  fs::create_directory(folder_ / ("W.npy." + std::to_string(getpid()) + ".partial"));
  OutputFile("--output", path.string()).write("new");
  EXPECT_EQ(contents(path), "new");
  EXPECT_EQ(files(), 3U);
}

TEST_F(OutputFiles, OfTheSameNameAreWrittenAtOnceWithoutMixing) {
  const fs::path path = folder_ / "W.npy";
  const OutputFile one("--output", path.string());
  const OutputFile other("--output", path.string());
  EXPECT_NE(one.temporary_path(), other.temporary_path());
}

TEST_F(OutputFiles, GoThroughASymbolicLinkWithoutReplacingIt) {
  std::ofstream(folder_ / "real") << "old";
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
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(OutputFile("--output", (folder_ / "file" / "W.npy").string()), BadArgument);
  EXPECT_EQ(files(), 1U);
}

}  // namespace
}  // namespace isosyrk::testing
