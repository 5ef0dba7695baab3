// All parallelism of the library: the operations of this room share their work among OpenMP threads.
#pragma once

#include <cstddef>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/split/flush_denormals.h"

namespace isosyrk {

/// A share of the work on one matrix: parts first ... end - 1 of `parts` equal ones.  Each entry is
/// formed as in the whole, so that shares put together are the whole bit for bit.
struct Share {
  Index first = 0;
  Index end = 1;
  Index parts = 1;

  bool is_first() const { return first == 0; }
};

/// While one lives, the operations of this room run on so many threads where they are called by the
/// thread that made it, and denormal numbers count as 0 in each of them (FlushDenormals).
class ThreadScope {
 public:
  /// Throws std::invalid_argument unless 1 <= threads <= most.
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

  static constexpr int most = 64;
  /// Throws as the constructor; returns `threads`.
  static int checked(int threads);

 private:
  int before_;
  FlushDenormals flush_;
};

/// Whether this process has had a parallel region of more than one thread.  A child that is forked
/// after that and opens one of its own would wait for ever (GCC bug 60035).
bool has_run_in_parallel();

namespace parallel {

inline constinit thread_local int current_threads = 1;

/// Blocks of rows into which sums over an n x n matrix are cut: fixed by n, so that every number of
/// threads adds in the same order.
inline Index sum_blocks(Index n) {
  constexpr Index rows_of_block = 16;
  constexpr Index most_blocks = 16;
  if (n < 3 * rows_of_block) return 1;
  return n / rows_of_block < most_blocks ? n / rows_of_block : most_blocks;
}
inline constexpr Index most_sum_blocks = 16;

/// Rows begin ... end - 1.
struct Rows {
  Index begin;
  Index end;
};
inline Rows rows_of_share(Index n, Share share) {
  return {n * share.first / share.parts, n * share.end / share.parts};
}

// Calls body(context, thread, threads) on all threads of a region.
void run_region(void (*body)(void* context, int thread, int threads), void* context);

/// Calls f(item, share, thread) so that the shares of each item below `items` make up the whole of
/// it, and returns once all are done.  Item i is weight(i) >= 1 times as much work as the unit; each
/// thread has as much work as the others, and neighbouring items.  f may not throw.
template <class Weight, class F>
void for_each_share(Index items, Weight&& weight, F&& f) {
  if (current_threads == 1) {
    for (Index item = 0; item < items; ++item) f(item, Share{}, 0);
    return;
  }
  auto of_thread = [&](int thread, int threads) {
    // Item i has threads * weight(i) parts; each thread takes as many as the weights add up to.
    Index all = 0;
    for (Index item = 0; item < items; ++item) all += weight(item);
    const Index begin = thread * all;
    const Index end = begin + all;
    Index before = 0;
    for (Index item = 0; item < items; ++item) {
      const Index parts = threads * weight(item);
      const Index first = begin > before ? begin - before : 0;
      const Index last = end - before < parts ? end - before : parts;
      if (first < last) {
        f(item, first == 0 && last == parts ? Share{} : Share{first, last, parts}, thread);
      }
      before += parts;
    }
  };
  run_region(
      [](void* context, int thread, int threads) {
        (*static_cast<decltype(of_thread)*>(context))(thread, threads);
      },
      &of_thread);
}
template <class F>
void for_each_share(Index items, F&& f) {
  for_each_share(items, [](Index) { return Index{1}; }, f);
}

/// Calls f(item, block) for every block below `blocks` of every item below `items`, and returns once
/// all are done.  With one thread, all items of a block follow one another, so that what they read
/// in common stays in the cache.  f may not throw.
template <class F>
void for_each_block(Index items, Index blocks, F&& f) {
  if (current_threads == 1) {
    for (Index block = 0; block < blocks; ++block) {
      for (Index item = 0; item < items; ++item) f(item, block);
    }
    return;
  }
  auto of_thread = [&](int thread, int threads) {
    const Index all = items * blocks;
    for (Index k = thread * all / threads; k < (thread + 1) * all / threads; ++k) {
      f(k / blocks, k % blocks);
    }
  };
  run_region(
      [](void* context, int thread, int threads) {
        (*static_cast<decltype(of_thread)*>(context))(thread, threads);
      },
      &of_thread);
}

}  // namespace parallel
}  // namespace isosyrk
