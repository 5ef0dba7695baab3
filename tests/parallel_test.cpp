// Threads: the whole work, shared out.  That answers are the same is tested in fast_forms_test.cpp.
#include "isosyrk/split/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

using parallel::current_threads;
using parallel::for_blocks;
using parallel::for_each_block;
using parallel::for_each_share;

// How often each of some blocks was done.
class Counts {
 public:
  explicit Counts(Index blocks) : of_(static_cast<std::size_t>(blocks)) {}

  void count(Index block) { ++of_[static_cast<std::size_t>(block)]; }
  bool are_all(int wanted) const {
    return std::ranges::all_of(of_, [&](const auto& each) { return each == wanted; });
  }

 private:
  std::vector<std::atomic<int>> of_;
};

TEST(Blocks, AreEachDoneOnceInEveryOperationByAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3, 8}) {
    on_threads(threads, [&] {
      for (int operation = 0; operation < 300; ++operation) {
        for (const Index blocks : {0, 1, 2, 7, 64}) {
          Counts counts(blocks);
          for_blocks(blocks, [&](Index block, int thread) {
            EXPECT_TRUE(0 <= thread && thread < threads);
            counts.count(block);
          });
          EXPECT_TRUE(counts.are_all(1)) << threads << " threads, " << blocks << " blocks";
        }
      }
    });
  }
  EXPECT_FALSE(Counts(1).are_all(1)) << "what is left out shows";
}

TEST(Blocks, CoverTheRowsOfEveryMatrixAndAreAsManyByAnyNumberOfThreads) {
  constexpr std::size_t items = 3;
  for (const Index n : {1, 5, 47, 48, 129, 1025, 2000}) {
    for (const int threads : {1, 3}) {
      Counts rows_done(static_cast<Index>(items) * n);
      std::atomic<Index> blocks{0};
      on_threads(threads, [&] {
        for_each_block(items, n, [&](std::size_t item, parallel::Rows rows, Index block) {
          EXPECT_LT(block, parallel::blocks_of(n));
          for (Index row = rows.begin; row < rows.end; ++row) {
            rows_done.count(static_cast<Index>(item) * n + row);
          }
          ++blocks;
        });
      });
      EXPECT_TRUE(rows_done.are_all(1)) << n;
      EXPECT_EQ(blocks, static_cast<Index>(items) * parallel::blocks_of(n));
    }
  }
}

TEST(Blocks, AreSharesThatCoverEachMatrixOrTheWholeOfItForOneThread) {
  constexpr Index n = 200;
  for (const int threads : {1, 2, 4}) {
    Counts rows_done(2 * n);
    on_threads(threads, [&] {
      for_each_share(2, n, [&](std::size_t item, Share share) {
        EXPECT_EQ(share.parts == 1, threads == 1);
        const parallel::Rows rows = parallel::rows_of_share(n, share);
        for (Index row = rows.begin; row < rows.end; ++row) {
          rows_done.count(static_cast<Index>(item) * n + row);
        }
      });
    });
    EXPECT_TRUE(rows_done.are_all(1)) << threads;
  }
}

// With equal shares, fixed before, the thread that is held up would hold blocks that are never
// done.
TEST(Blocks, AreTakenByWhicheverThreadIsFree) {
  constexpr Index blocks = 64;
  for (const int threads : {2, 4}) {
    on_threads(threads, [&] {
      std::atomic<Index> done{0};
      for_blocks(blocks, [&](Index, int) {
        if (done.fetch_add(1) > 0) return;
        const auto begin = std::chrono::steady_clock::now();
        while (done < blocks) {
          std::this_thread::yield();
          ASSERT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
        }
      });
      EXPECT_EQ(done, blocks);
    });
  }
}

TEST(OnThreads, NestsAndIsOfTheThreadThatCalledIt) {
  int of_other = 0;
  on_threads(4, [&] {
    EXPECT_EQ(current_threads(), 4);
    on_threads(2, [&] { EXPECT_EQ(current_threads(), 4) << "the threads of the outer call"; });
    std::thread([&] { of_other = current_threads(); }).join();
    for (const int threads : {-1, 0, 65}) {
      EXPECT_THROW(on_threads(threads, [] {}), std::invalid_argument) << threads;
      EXPECT_THROW(checked_threads(threads), std::invalid_argument) << threads;
    }
    EXPECT_EQ(current_threads(), 4) << "what is refused changes nothing";
  });
  EXPECT_EQ(of_other, 1);
  EXPECT_EQ(current_threads(), 1);
  on_threads(1, [] { EXPECT_EQ(current_threads(), 1); });
  EXPECT_NO_THROW(on_threads(64, [] {}));
}

TEST(OnThreads, ThrowsOnWhatIsThrownAndServesTheNextCall) {
  for (const int threads : {1, 2}) {
    EXPECT_THROW(on_threads(threads, [] { throw std::out_of_range("of the body"); }),
                 std::out_of_range);
    EXPECT_EQ(current_threads(), 1);
    Counts counts(9);
    on_threads(threads, [&] { for_blocks(9, [&](Index block, int) { counts.count(block); }); });
    EXPECT_TRUE(counts.are_all(1));
  }
}

TEST(OnThreads, WakesThreadsThatSleep) {
  on_threads(3, [] {
    for (int operation = 0; operation < 3; ++operation) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));  // longer than they wait awake
      std::atomic<int> here{0};
      for_blocks(3, [&](Index, int) {
        ++here;
        while (here < 3) std::this_thread::yield();  // each block by another thread
      });
      EXPECT_EQ(here, 3);
    }
  });
}

TEST(OnThreads, MeasuresOperationsWhereItIsAskedTo) {
  OperationTimes times;
  const auto operations = [] {
    for (int k = 0; k < 5; ++k) {
      for_blocks(4, [](Index, int) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); });
    }
  };
  for (const int threads : {1, 2}) {
    times = {};
    on_threads(threads, [&] {
      measure_operations(&times);
      operations();
      measure_operations(nullptr);
      operations();
    });
    EXPECT_EQ(times.operations, 5);
    EXPECT_GE(times.busy, 5 * 4 * 2e-3 * 0.99);
    EXPECT_GE(times.within, times.busy / threads * 0.99);
  }
}

// Which threads of a region of the test's own, those of the library, keep denormals.
constexpr int looked_at = 4;
std::array<bool, looked_at> threads_that_keep_denormals() {
  std::array<bool, looked_at> kept{};
#pragma omp parallel for num_threads(looked_at) schedule(static, 1)
  for (int t = 0; t < looked_at; ++t) kept[static_cast<std::size_t>(t)] = keeps_denormals();
  return kept;
}

TEST(OnThreads, FlushesDenormalsInEveryThreadWhileItLastsAndNoLonger) {
#if !defined(__SSE2__)
  GTEST_SKIP() << "only x86 is told";
#endif
  for (const int threads : {1, 2, 3, looked_at, 8}) {
    ASSERT_TRUE(keeps_denormals());
    std::atomic<int> flushed{0};
    on_threads(threads, [&] {
      std::atomic<int> here{0};
      for_blocks(threads, [&](Index, int) {
        flushed += flushes_denormals();
        ++here;
        while (here < threads) std::this_thread::yield();  // each block by another thread
      });
      on_threads(1, [] {});
      EXPECT_TRUE(flushes_denormals());
    });
    EXPECT_EQ(flushed, threads);
    EXPECT_TRUE(keeps_denormals());
    EXPECT_EQ(threads_that_keep_denormals(), (std::array<bool, looked_at>{true, true, true, true}));
  }
}

}  // namespace
}  // namespace isosyrk::testing
