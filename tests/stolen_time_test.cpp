#include "benchmarks/stolen_time.h"

#include <gtest/gtest.h>

#include <sstream>

namespace isosyrk::testing {
namespace {

double stolen_in(const std::string& text) {
  std::istringstream stat(text);
  return stolen_seconds(stat, 100.0);
}

TEST(StolenTime, IsTheEighthNumberOfTheFirstLineInSeconds) {
  EXPECT_EQ(stolen_in("cpu  2062857 9640 164889 2437865 2810 0 2047 135119 0 0\ncpu0 1 2 3 4 5"),
            1351.19);
}

TEST(StolenTime, IsNoneWhereTheSystemDoesNotTell) {
  for (const char* text : {"", "cpu  1 2 3 4 5 6 7\n", "intr 1 2 3 4 5 6 7 8\n", "cpu 1 2 3 x",
                           "cpu  1 2 3 4 5 6 7 -8\n"}) {
    EXPECT_EQ(stolen_in(text), 0.0) << text;
  }
}

TEST(StolenTime, NeverGrowsLess) {
  const double before = stolen_seconds();
  EXPECT_GE(before, 0.0);
  EXPECT_GE(stolen_seconds(), before);
}

}  // namespace
}  // namespace isosyrk::testing
