#include "benchmarks/peak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "benchmarks/median.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(CoresAtOnce, AreOneForTwoThreadsOnOneProcessor) {
  const std::vector<std::size_t> processors = allowed_processors();
  run_on({processors[0]});
  double least = cores_at_once();
  for (int again = 0; again < 2; ++again) least = std::min(least, cores_at_once());
  run_on(processors);
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
