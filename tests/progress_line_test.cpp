// What a person reads of the time that a run takes.
#include "benchmarks/integrate/progress_line.h"

#include <gtest/gtest.h>

#include <limits>

namespace isosyrk::testing {
namespace {

TEST(DurationText, HasTheTwoLargestUnitsEachBelowTheNext) {
  EXPECT_EQ(duration_text(0.4), "0 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1 min 0 s");
  EXPECT_EQ(duration_text(3599.0), "59 min 59 s");
  EXPECT_EQ(duration_text(3600.0), "1 h 0 min");
  EXPECT_EQ(duration_text(7500.0), "2 h 5 min");
  EXPECT_EQ(duration_text(360000.0), "100 h 0 min");
}

}  // namespace
}  // namespace isosyrk::testing
