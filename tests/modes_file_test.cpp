#include "benchmarks/modes_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

std::vector<Mode> read(const std::string& text) {
  std::istringstream input(text);
  return read_modes(input, "modes.csv", 5);
}

TEST(ModesFile, IsReadWhateverTheOrderOfItsColumnsAndItsLineEnds) {
  for (const char* text :
       {"l,m,re,im\n2,1,0.5,-1e-3\n", "\xEF\xBB\xBFl, m ,re,im\r\n2,1, +0.5,-0.001\r\n\r\n",
        "im,re,m,l\n-1e-3,5e-1,1,2"}) {
    const std::vector<Mode> modes = read(text);
    ASSERT_EQ(modes.size(), 1U);
    EXPECT_EQ(modes[0].l, 2);
    EXPECT_EQ(modes[0].m, 1);
    EXPECT_EQ(modes[0].value, Complex(0.5, -1e-3));
  }
}

TEST(ModesFile, OfTheDefaultModesGivesTheirHash) {
  const auto modes = read_modes_file(std::string(ISOSYRK_TEST_DATA "/initial_modes.csv"), 5);
  EXPECT_EQ(hash_of(modes), hash_of(default_modes()));
  auto changed = modes;
  changed.back().value += 1e-16;
  EXPECT_NE(hash_of(changed), hash_of(modes));
}

TEST(ModesFile, ThatIsBrokenIsRefusedWithItsLine) {
  const auto refused = [](const std::string& text, const std::string& message) {
    try {
      read(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), "modes.csv" + message);
    }
  };
  refused("", ": empty; must have the header l,m,re,im");
  refused("\n\n", ": empty; must have the header l,m,re,im");
  refused("l,m,re,im\n", ": no modes; must have at least one line");
  for (const char* header : {"l,m,re", "l,m,re,im,x", "l,m,re,re", "1,0,1,0"}) {
    refused(std::string(header) + "\n1,0,1,0\n",
            ", line 1: the header must name l,m,re,im and no other");
  }
  // Lines after the header.
  const auto refused_line = [&](const std::string& line, const std::string& message) {
    refused("l,m,re,im\n" + line + "\n", ", line 2: " + message);
    refused("l,m,re,im\n\n" + line + "\n", ", line 3: " + message);
  };
  refused_line("1,0,1", "3 fields; must be 4 (l,m,re,im)");
  refused_line("1.5,0,1,0", "l = '1.5' is not a whole number");
  refused_line("1,x,1,0", "m = 'x' is not a whole number");
  refused_line("1,0,,0", "re = '' is not a number");
  refused_line("1,0,1,0x1", "im = '0x1' is not a number");
  refused_line("1,0,+-1,0", "re = '+-1' is not a number");
  refused_line("+-1,0,1,0", "l = '+-1' is not a whole number");
  refused_line("99999999999,0,1,0", "l = '99999999999' is not a whole number");
  refused_line("0,0,1,0", "mode l=0, m=0: l must be 1 to n-1 = 4");
  refused_line("5,0,1,0", "mode l=5, m=0: l must be 1 to n-1 = 4");
  refused_line("2,-1,1,0", "mode l=2, m=-1: m must be 0 to l");
  refused_line("2,3,1,0", "mode l=2, m=3: m must be 0 to l");
  refused_line("2,1,inf,0", "mode l=2, m=1: value inf + 0i must be finite");
  refused_line("2,1,0,nan", "mode l=2, m=1: value 0 + nani must be finite");
  refused_line("2,0,1,0.5", "mode l=2, m=0: im = 0.5 must be 0 where m = 0");
}

TEST(ModesFile, MayHaveModesAtTheEndsOfTheRanges) {
  for (const char* text :
       {"l,m,re,im\n1,0,1,0\n", "l,m,re,im\n4,0,1,0\n", "l,m,re,im\n4,4,1,1\n"}) {
    EXPECT_EQ(read(text).size(), 1U) << text;
  }
}

using ModesFileOnDisk = WithFolder;

// Files whose lines are right, each by itself.
TEST_F(ModesFileOnDisk, WhoseModesDoNotFitTogetherIsNamedWithTheMode) {
  const auto refused = [&](const std::string& lines, const std::string& message) {
    const std::string path = write("modes.csv", "l,m,re,im\n" + lines).string();
    expect_refused([&] { read_modes_file(path, 5); }, "--modes " + path + ": " + message);
  };
  refused("2,1,1,0\n2,0,1,0\n2,1,0,1\n", "mode l=2, m=1: given twice, allowed once");
  refused("2,1,0,0\n2,0,0,0\n", "modes: at least one must be nonzero");
  const std::string path = write("modes.csv", "l,m,re,im\n2,1,1,0\n2,-1,1,0\n").string();
  expect_refused([&] { read_modes_file(path, 5); },
                 "--modes " + path + ", line 3: mode l=2, m=-1: m must be 0 to l");
}

TEST(ModesFile, ThatCannotBeReadIsNamed) {
  EXPECT_THROW(read_modes_file("no/such/file.csv", 5), std::invalid_argument);
  EXPECT_THROW(read_modes_file(ISOSYRK_TEST_DATA, 5), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
