// Two threads that share tasks.
#include "isosyrk/split/team.h"

#include <gtest/gtest.h>
#include <time.h>

#include <array>
#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support.h"

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

// How often each half of each item was done.
struct Marks {
  explicit Marks(std::size_t items) : halves(items) {}

  void mark(std::size_t item, Share share) {
    for_halves(share, [&](Share half) { ++halves[item][static_cast<std::size_t>(half.part)]; });
  }

  std::vector<std::array<std::atomic<int>, 2>> halves;
};

std::vector<Items> tested_items() {
  std::vector<Items> all = {Items(4, 2), Items(6, 2), Items(2, 2), Items(3, 3)};
  for (const std::size_t count : {0, 1, 2, 3, 4, 7, 20}) all.emplace_back(count);
  return all;
}

TEST(Team, DoesAllPhasesOfAllItemsInTurn) {
  for (const int threads : {1, 2}) {
    Team team(threads);
    for (const Items& items : tested_items()) {
      for (int round = 0; round < 100; ++round) {
        Marks first(items.count), second(items.count);
        std::atomic<int> too_early{0};
        team.run_phases(
            items, [&](std::size_t item, Share share, std::size_t) { first.mark(item, share); },
            [&](std::size_t item, Share share, std::size_t) {
              for (const auto& half : first.halves[item]) too_early += half != 1;
              second.mark(item, share);
            });
        EXPECT_EQ(too_early, 0) << items.count << " " << items.halved;
        for (const auto& item : second.halves) {
          EXPECT_EQ(item[0], 1);
          EXPECT_EQ(item[1], 1);
        }
      }
    }
  }
}

// However long each takes: each task spins for some random time, so that the threads get ahead of
// one another in every way.
TEST(Team, DoesAllPhasesInTurnWhoeverIsAhead) {
  Team team(2);
  std::array<std::minstd_rand, 2> random{std::minstd_rand(1), std::minstd_rand(2)};
  const auto spin = [&](std::size_t thread) {
    const auto until = std::chrono::steady_clock::now() +
                       std::chrono::microseconds(random[thread]() % 8 == 0 ? 60 : 2);
    while (std::chrono::steady_clock::now() < until) {
    }
  };
  for (const Items& items : {Items(3), Items(5), Items(6, 2), Items(1)}) {
    for (int round = 0; round < 600; ++round) {
      std::array<Marks, 4> marks{Marks(items.count), Marks(items.count), Marks(items.count),
                                 Marks(items.count)};
      std::atomic<int> too_early{0};
      const auto phase = [&](std::size_t k) {
        return [&, k](std::size_t item, Share share, std::size_t thread) {
          if (k > 0) {
            for (const auto& half : marks[k - 1].halves[item]) too_early += half != 1;
          }
          spin(thread);
          marks[k].mark(item, share);
        };
      };
      switch (round % 4) {
        case 0:
          team.run_phases(items, phase(0), phase(1), phase(2), phase(3));
          break;
        case 1:
          team.run_phases(items, undivided(0, phase(0)), undivided(1, phase(1)),
                          undivided(1, phase(2)), phase(3));
          break;
        case 2:
          team.run_phases(items, undivided(1, phase(0)), phase(1), undivided(0, phase(2)),
                          undivided(1, phase(3)));
          break;
        default:
          team.run_phases(items, undivided(0, phase(0)), undivided(0, phase(1)),
                          undivided(0, phase(2)), undivided(0, phase(3)));
      }
      ASSERT_EQ(too_early, 0) << items.count;
      for (const Marks& of_phase : marks) {
        for (const auto& item : of_phase.halves) {
          ASSERT_EQ(item[0] + 10 * item[1], 11) << items.count;
        }
      }
    }
  }
}

// Rounds of one phase and of four by turns: who is late, and finds the phases of the next round,
// has none to do in his own.  (Where phases were taken by their number alone, up to some tens of
// these rounds went wrong.)
TEST(Team, TakesNothingOfARoundThatIsOver) {
  Team team(2);
  long wrong = 0;
  for (int round = 0; round < 200000; ++round) {
    std::array<std::atomic<int>, 4> halves{};
    const auto phase = [&](std::size_t k) {
      return [&, k](std::size_t, Share share, std::size_t) { halves[k] += share.parts == 2; };
    };
    if (round % 2 == 0) {
      team.run_phases(Items(1), phase(0));
    } else {
      team.run_phases(Items(1), phase(0), phase(1), phase(2), phase(3));
    }
    const int expected_later = round % 2 == 0 ? 0 : 2;
    wrong += halves[0] != 2;
    for (const std::size_t k : {1, 2, 3}) wrong += halves[k] != expected_later;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Team, HalvesUndividedPhasesOnlyWhereNothingIsWhole) {
  Team team(2);
  for (const Items& items : {Items(1), Items(2, 2), Items(3), Items(6, 2)}) {
    const std::size_t whole = items.whole();
    std::array<std::atomic<long>, 2> parts{};  // of the shares of items in halves
    const auto phase = [&](std::size_t k) {
      return [&, k](std::size_t item, Share share, std::size_t) {
        if (item >= whole) parts[k] += share.parts;
      };
    };
    team.run_phases(items, undivided(1, phase(0)), phase(1));
    const long in_halves = 4 * static_cast<long>(items.halved);  // two shares of two parts
    EXPECT_EQ(parts[0], whole == 0 ? in_halves : static_cast<long>(items.halved)) << items.count;
    EXPECT_EQ(parts[1], in_halves) << items.count;
  }
}

TEST(Team, LeavesAnUndividedPhaseToItsThread) {
  Team team(2);
  for (const std::size_t owner : {0, 1}) {
    std::atomic<bool> is_done{false}, is_busy{false};
    std::atomic<std::size_t> done_by{2};
    team.run_phases(Items(3), undivided(owner, [&](std::size_t item, Share, std::size_t thread) {
                      if (item == 2) {
                        while (!is_busy) std::this_thread::yield();
                        done_by = thread;
                        is_done = true;
                      } else if (thread != owner) {  // in the meantime, as long as it takes
                        is_busy = true;
                        while (!is_done) std::this_thread::yield();
                      }
                    }));
    EXPECT_EQ(done_by, owner);
  }
}

// The second is kept busy by its whole item until the first has done all phases of both halves.
TEST(Team, DoesWhatTheOtherHasNotBegun) {
  Team team(2);
  constexpr std::size_t phases = 3;
  std::atomic<std::size_t> halves_done{0};
  std::atomic<bool> second_is_busy{false}, in_time{true};
  const auto phase = [&](std::size_t item, Share share, std::size_t thread) {
    using namespace std::chrono_literals;
    const auto wait_for = [](auto&& condition) {
      const auto until = std::chrono::steady_clock::now() + 10s;
      while (!condition() && std::chrono::steady_clock::now() < until) std::this_thread::yield();
      return condition();
    };
    if (share.parts == 2) {
      // The first of them only once the second thread has something to do that keeps it.
      if (thread == 0 && halves_done < 2) wait_for([&] { return second_is_busy.load(); });
      ++halves_done;
    } else if (item == 1 && thread == 1) {
      second_is_busy = true;
      if (!wait_for([&] { return halves_done == 2 * phases; })) in_time = false;
    }
  };
  team.run_phases(Items(3), phase, phase, phase);
  EXPECT_TRUE(second_is_busy);
  EXPECT_TRUE(in_time);
  EXPECT_EQ(halves_done, 2 * phases);
}

TEST(Team, DoesBothHalvesOfAllItems) {
  for (const int threads : {1, 2}) {
    Team team(threads);
    for (const Items& items : tested_items()) {
      Marks done(items.count);
      team.run_halves(items, [&](std::size_t item, Share half, std::size_t) {
        EXPECT_EQ(half.parts, 2);
        done.mark(item, half);
      });
      for (const auto& item : done.halves) {
        EXPECT_EQ(item[0], 1);
        EXPECT_EQ(item[1], 1);
      }
    }
  }
}

TEST(Team, KeepsHalvesWhereTheirItemsAre) {
  Team team(2);
  // After each task a thread waits for the other to have done as many: so both do the same number.
  for (const Items& items : {Items(4), Items(3), Items(6, 2)}) {
    std::vector<std::size_t> of_item(items.count), of_half(items.count);
    using Done = std::array<std::atomic<int>, 2>;
    const auto together = [](Done& done, std::size_t thread, auto&& work) {
      work();
      const int own = ++done[thread];
      while (done[1 - thread] < own) std::this_thread::yield();
    };
    Done phases{}, halves{};
    team.run_phases(items, [&](std::size_t item, Share share, std::size_t thread) {
      together(phases, thread, [&] {
        if (share.parts == 1) of_item[item] = thread;
      });
    });
    team.run_halves(items, [&](std::size_t item, Share, std::size_t thread) {
      together(halves, thread, [&] {
        if (item < items.whole()) of_half[item] = thread;
      });
    });
    EXPECT_EQ(of_half, of_item) << items.count;
  }
}

double cpu_seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

TEST(Team, SleepsWhenThereIsNothingToDo) {
  using namespace std::chrono_literals;
  Team team(2);
  team.run(2, [](std::size_t, std::size_t) {});
  std::this_thread::sleep_for(100ms);  // now it has noticed
  const double before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  std::this_thread::sleep_for(200ms);
  EXPECT_LT(cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - before, 0.05);  // 0.2 if it did not sleep
}

// A round in which each thread has a task; tells what the second has worked so far.
double seconds_of_second(Team& team) {
  double seconds = 0;
  std::atomic<int> begun{0};
  team.run(2, [&](std::size_t, std::size_t thread) {
    ++begun;
    while (begun.load() < 2) std::this_thread::yield();
    if (thread == 1) seconds = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
  });
  return seconds;
}

// The second thread shares its core with another that always has work, while the first is busy with
// rounds in which there is little else to do.
TEST(Team, LeavesItsCoreToOthersWhileItWaits) {
  using std::chrono::steady_clock;
  const std::vector<std::size_t> processors = allowed_processors();
  if (processors.size() < 2) GTEST_SKIP() << "one processor only";
  run_on({processors[0]});
  Team team(2);
  std::atomic<bool> ends{false};
  double of_other = 0;
  std::thread other([&] {
    while (!ends) {
    }
    of_other = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
  });
  run_on({processors.begin() + 1, processors.end()});
  const double before = seconds_of_second(team);
  int done_by_second = 0;
  for (int round = 0; round < 100; ++round) {
    team.run(2, [&](std::size_t, std::size_t thread) {
      if (thread == 1) ++done_by_second;
      const auto until = steady_clock::now() + std::chrono::milliseconds(thread == 0 ? 5 : 0);
      while (steady_clock::now() < until) {
      }
    });
  }
  const double of_second = seconds_of_second(team) - before;
  ends = true;
  other.join();
  run_on(processors);
  EXPECT_GT(of_second, 0);
  EXPECT_LT(of_second, 0.03 * of_other);  // as much if it kept its core
  EXPECT_LT(done_by_second, 50);          // nearly all if it did not rest
}

TEST(Team, OfOtherSizesIsRefused) {
  EXPECT_THROW(Team(0), std::invalid_argument);
  EXPECT_THROW(Team(3), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
