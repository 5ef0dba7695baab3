#include "benchmarks/peak.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>

#include "benchmarks/median.h"

namespace isosyrk::testing {
namespace {

TEST(CoresAtOnce, AreOneForTwoThreadsOnOneProcessor) {
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  double least = cores_at_once();
  for (int again = 0; again < 2; ++again) least = std::min(least, cores_at_once());
  ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
  EXPECT_GT(least, 0.0);
  EXPECT_LT(least, 1.3);  // others may have work here too
}

TEST(Median, IsTheMiddleOneOrTheUpperOfTwo) {
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
}

}  // namespace
}  // namespace isosyrk::testing
