// Two threads that share tasks.
#include "core/team.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace isosyrk::testing {
namespace {

TEST(Team, DoesEveryTaskOnce) {
  for (const int threads : {1, 2}) {
    Team team(threads);
    EXPECT_EQ(team.threads(), threads);
    for (const std::size_t count : {0, 1, 2, 3, 7, 100}) {
      std::vector<int> done(count, 0);
      team.run(count, [&](std::size_t index, std::size_t thread) {
        ASSERT_LT(thread, static_cast<std::size_t>(threads));
        ++done[index];
      });
      EXPECT_EQ(done, std::vector<int>(count, 1)) << threads;
    }
  }
}

TEST(Team, HasDoneEverythingWhenItReturns) {
  Team team(2);
  std::vector<long> sums(2, 0);  // not atomic: each round must see what the one before wrote
  for (long round = 0; round < 20000; ++round) {
    team.run(2, [&](std::size_t index, std::size_t) { sums[index] += round; });
    std::swap(sums[0], sums[1]);
    ASSERT_EQ(sums[0], sums[1]);
  }
}

TEST(Team, SharesLongTasks) {
  Team team(2);
  // Each of two tasks waits for the other to have begun: one thread alone would never end.
  std::atomic<int> begun{0};
  std::array<std::size_t, 2> done_by{};
  team.run(2, [&](std::size_t index, std::size_t thread) {
    ++begun;
    while (begun.load() < 2) std::this_thread::yield();
    done_by[index] = thread;
  });
  EXPECT_EQ(begun.load(), 2);
  EXPECT_EQ(done_by[0], 0u);  // from the front
  EXPECT_EQ(done_by[1], 1u);  // from the back
}

TEST(Team, OfOtherSizesIsRefused) {
  EXPECT_THROW(Team(0), std::invalid_argument);
  EXPECT_THROW(Team(3), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
