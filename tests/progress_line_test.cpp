// What a person reads of a run while it goes.
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

// What a line prints of a run of ten steps, on a stderr that is no terminal.
std::string log_of(bool wanted, std::chrono::steady_clock::duration interval,
                   const Progress& begun = {}) {
  ::testing::internal::CaptureStderr();
  {
    ProgressLine line(10, 0.5, wanted, begun, interval);
    for (long k = begun.steps + 1; k < begun.steps + 3; ++k) line.show({k, 0.25, 3 * k});
  }
  return ::testing::internal::GetCapturedStderr();
}

TEST(ProgressLine, IsALineOfALogAsOftenAsItIsDue) {
  const auto at_once = std::chrono::seconds(0);
  EXPECT_EQ(log_of(true, at_once, {.energy = 0.25}),
            "step 0 of 10 (0 %), t = 0, energy 0.25\n"
            "step 1 of 10 (10 %), t = 0.5, energy 0.25, 3 sweeps a step, about 0 s left\n"
            "step 2 of 10 (20 %), t = 1, energy 0.25, 3 sweeps a step, about 0 s left\n");
  EXPECT_EQ(log_of(true, std::chrono::minutes(1)), "");
  EXPECT_EQ(log_of(false, at_once), "");
}

TEST(ProgressLine, SaysNothingOfTheTimeLeftBeforeTheFirstStepOfARunThatGoesOn) {
  const std::string log = log_of(true, std::chrono::seconds(0), {5, 0.25, 15});
  EXPECT_TRUE(log.starts_with("step 5 of 10 (50 %), t = 2.5, energy 0.25, 3 sweeps a step\n"))
      << log;
}

}  // namespace
}  // namespace isosyrk::testing
