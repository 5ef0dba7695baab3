// Threads: the whole work, shared out.  That answers are the same is tested in fast_forms_test.cpp.
#include "isosyrk/split/parallel.h"

#include <array>
#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <vector>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

using parallel::current_threads;
using parallel::for_each_share;

const std::vector<std::vector<Index>> weights_tested = {
    {1, 1, 1, 1, 1, 1, 1}, {2, 1, 2, 1, 2, 1, 2}, {1, 2, 2, 2, 1, 1, 2}, {5, 1, 1, 1, 1, 1, 1}};

// One thread does whole items.
void expect_shares_cover_once(int threads, const std::vector<Index>& weights, Index items) {
  const auto weight = [&](Index i) { return weights[static_cast<std::size_t>(i)]; };
  std::mutex mutex;
  std::set<std::tuple<Index, Index, Index>> parts;  // (item, part, of how many)
  std::array<double, 8> covered{}, work{};          // of each item, by each thread
  const ThreadScope scope(threads);
  for_each_share(items, weight, [&](Index item, Share share, int thread) {
    const std::lock_guard lock(mutex);
    ASSERT_LT(thread, threads);
    EXPECT_LT(share.first, share.end);
    EXPECT_LE(share.end, share.parts);
    EXPECT_TRUE(threads > 1 || share.parts == 1);
    for (Index part = share.first; part < share.end; ++part) {
      EXPECT_TRUE(parts.emplace(item, part, share.parts).second) << "twice";
    }
    const double size =
        static_cast<double>(share.end - share.first) / static_cast<double>(share.parts);
    covered[static_cast<std::size_t>(item)] += size;
    work[static_cast<std::size_t>(thread)] += size * static_cast<double>(weight(item));
  });
  double whole = 0.0;
  for (Index item = 0; item < items; ++item) {
    EXPECT_NEAR(covered[static_cast<std::size_t>(item)], 1.0, 1e-12) << item;
    whole += static_cast<double>(weight(item));
  }
  for (int t = 0; t < threads; ++t) {
    EXPECT_NEAR(work[static_cast<std::size_t>(t)], whole / threads, 1e-12) << t;
  }
}

TEST(Shares, CoverEveryItemExactlyOnceAndGiveEachThreadAsMuch) {
  for (int threads = 1; threads <= 8; ++threads) {
    for (const auto& weights : weights_tested) {
      for (Index items = 0; items <= 7; ++items) {
        SCOPED_TRACE(::testing::Message() << threads << " threads, " << items << " items");
        expect_shares_cover_once(threads, weights, items);
      }
    }
  }
}

TEST(ThreadScope, NestsRestoresAndIsOfTheThreadThatMadeIt) {
  {
    const ThreadScope outer(4);
    {
      const ThreadScope inner(2);
      EXPECT_EQ(current_threads, 2);
      const ThreadScope one(1);
      EXPECT_EQ(current_threads, 1);
    }
    int of_other = 0;
    std::thread([&] { of_other = current_threads; }).join();
    EXPECT_EQ(of_other, 1);
    for (const int threads : {-1, 0, 65}) {
      EXPECT_THROW(ThreadScope{threads}, std::invalid_argument) << threads;
      EXPECT_THROW(ThreadScope::checked(threads), std::invalid_argument) << threads;
    }
    EXPECT_EQ(current_threads, 4) << "what is refused changes nothing";
  }
  EXPECT_EQ(current_threads, 1);
  EXPECT_NO_THROW(ThreadScope{64});
}

// Which threads of a region of the test's own, those of the library, keep denormals.
constexpr int looked_at = 4;
std::array<bool, looked_at> threads_that_keep_denormals() {
  std::array<bool, looked_at> kept{};
#pragma omp parallel for num_threads(looked_at) schedule(static, 1)
  for (int t = 0; t < looked_at; ++t) kept[static_cast<std::size_t>(t)] = keeps_denormals();
  return kept;
}

TEST(ThreadScope, FlushesDenormalsInEveryThreadWhileItLastsAndNoLonger) {
#if !defined(__SSE2__)
  GTEST_SKIP() << "only x86 is told";
#endif
  for (const int threads : {1, 2, 3, looked_at, 8}) {
    ASSERT_TRUE(keeps_denormals());
    std::atomic<int> flushed{0};
    {
      const ThreadScope scope(threads);
      for_each_share(threads, [&](Index, Share, int) { flushed += flushes_denormals(); });
      { const ThreadScope inner(1); }
      EXPECT_TRUE(flushes_denormals());
    }
    EXPECT_EQ(flushed, threads);
    EXPECT_TRUE(keeps_denormals());
    EXPECT_EQ(threads_that_keep_denormals(), (std::array<bool, looked_at>{true, true, true, true}));
  }
}

}  // namespace
}  // namespace isosyrk::testing
