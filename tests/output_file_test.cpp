#include "benchmarks/output_file.h"

#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

#include <sys/wait.h>
#include <unistd.h>

#include "benchmarks/arguments.h"
#include "benchmarks/npy_file.h"
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

// So are others, tested from outside; see tests/scripts/test_integrate.py.
TEST_F(OutputFiles, InAFileAreRefusedAtOnce) {
  write("file", "x");
  EXPECT_THROW(OutputFile("--output", (folder_ / "file" / "W.npy").string()), BadArgument);
  EXPECT_EQ(files(), 1U);
}

using NpyFile = WithFolder;

TEST_F(NpyFile, HoldsTheMatrixByRows) {
  Matrix W(2, 2);
  W << Complex(1, 2), Complex(3, 4), Complex(5, 6), Complex(7, 8);
  const std::string bytes = npy(W);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const auto header = static_cast<std::size_t>(static_cast<unsigned char>(bytes[8])) +
                      256U * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + header) % 64, 0U);
  EXPECT_EQ(bytes.size(), 10 + header + 4 * sizeof(Complex));
  EXPECT_NE(bytes.find("'descr': '<c16', 'fortran_order': False, 'shape': (2, 2)"),
            std::string::npos);
  double second_row_first = 0.0;
  std::memcpy(&second_row_first, bytes.data() + 10 + header + 2 * sizeof(Complex), sizeof(double));
  EXPECT_EQ(second_row_first, 5.0);

  // What is refused is tested from outside; see tests/scripts/test_integrate.py.
  EXPECT_EQ(read_npy(write("W.npy", bytes).string(), 2), W);
}

}  // namespace
}  // namespace isosyrk::testing
