// What a program is told of its machine: stolen time; and the median.
#include <sstream>

#include "benchmarks/median.h"
#include "benchmarks/stolen_time.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

std::vector<ProcessorTime> times_in(const std::string& text) {
  std::istringstream stat(text);
  return processor_times(stat, 100.0);
}

TEST(StolenTime, IsTheEighthNumberOfEachProcessorInSeconds) {
  const auto times = times_in(
      "cpu  2062857 9640 164889 2437865 2810 0 2047 135119 0 0\n"
      "cpu0 1062857 9640 64889 1437865 2810 1 1047 35119 0 0\n"
      "cpu1 1000000 0 100000 1000000 0 0 1000 100000 0 0\n"
      "intr 1 2 3 4 5 6 7 8\n");
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].worked, 11384.34);
  EXPECT_EQ(times[0].stolen, 351.19);
  EXPECT_EQ(times[1].worked, 11010.0);
  EXPECT_EQ(times[1].stolen, 1000.0);
}

TEST(StolenTime, IsNoneWhereTheSystemDoesNotTell) {
  for (const char* text : {"", "cpu0 1 2 3 4 5 6 7\n", "intr 1 2 3 4 5 6 7 8\n", "cpu0 1 2 3 x",
                           "cpu0 1 2 3 4 5 6 7 -8\n", "cpu  1 2 3 4 5 6 7 8\n"}) {
    EXPECT_TRUE(times_in(text).empty()) << text;
  }
  EXPECT_EQ(stolen_seconds({}, {}, 1), 0.0);
}

TEST(StolenTime, IsThatOfTheProcessorsThatWorked) {
  const std::vector<ProcessorTime> before = {{10, 1}, {20, 2}, {30, 3}};
  const std::vector<ProcessorTime> after = {{11, 1.5}, {24, 2.25}, {30, 4}};
  EXPECT_EQ(stolen_seconds(before, after, 1), 0.25);
  EXPECT_EQ(stolen_seconds(before, after, 2), 0.75);
  EXPECT_EQ(stolen_seconds(before, after, 9), 1.75);
}

TEST(Median, IsTheMiddleOneOrTheUpperOfTwo) {
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
}

}  // namespace
}  // namespace isosyrk::testing
