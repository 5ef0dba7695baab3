// All parallelism of the library.  The operations of this room share their work among OpenMP
// threads.
#pragma once

#include <cstddef>
#include <functional>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/split/flush_denormals.h"

namespace isosyrk {

/// A share of the work on one matrix: parts first ... end - 1 of `parts` equal parts.  The default
/// is all of it.  Each entry is formed alike in any share, so the result is the same bit for bit.
struct Share {
  Index first = 0;
  Index end = 1;
  Index parts = 1;

  bool is_first() const { return first == 0; }
};

/// Sets, for its lifetime, the number of threads on which operations of this room run when called
/// by the present thread.  All these threads treat denormal numbers as 0 (DenormalMode).
class ThreadScope {
 public:
  /// Throws std::invalid_argument unless 1 <= threads <= most.
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

  static constexpr int most = 64;
  /// Returns `threads`, or throws as the constructor does.
  static int checked(int threads);

 private:
  int before_;
  DenormalMode flushed_{true};
};

namespace parallel {

inline constinit thread_local int current_threads = 1;

/// Returns the number of blocks of rows into which sums over an n x n matrix are cut.  It depends
/// on n only, so that every number of threads adds in the same order.
inline Index sum_blocks(Index n) {
  constexpr Index rows_of_block = 16;
  constexpr Index most_blocks = 16;
  if (n < 3 * rows_of_block) return 1;
  return n / rows_of_block < most_blocks ? n / rows_of_block : most_blocks;
}
/// Upper bound of sum_blocks(n).
inline constexpr Index most_sum_blocks = 16;

/// Rows begin ... end - 1.
struct Rows {
  Index begin;
  Index end;
};
/// Returns the rows of a share of n rows.
inline Rows rows_of_share(Index n, Share share) {
  return {n * share.first / share.parts, n * share.end / share.parts};
}

// Calls body(thread, threads) on each thread of a parallel region, with current_threads threads or
// fewer if OpenMP has no more.  Returns when all are done.  A std::ref as body allocates nothing.
void run_region(const std::function<void(int thread, int threads)>& body);

/// Calls f(item, share, thread) for shares that together cover every item 0 ... items - 1, and
/// returns when all calls are done.  Item i takes weight(i) >= 1 units of work.  Every thread has
/// the same amount of work, on consecutive items.  f must not throw.
template <class Weight, class F>
void for_each_share(Index items, Weight&& weight, F&& f) {
  if (current_threads == 1) {
    for (Index item = 0; item < items; ++item) f(item, Share{}, 0);
    return;
  }
  auto of_thread = [&](int thread, int threads) {
    // Item i has threads * weight(i) parts.  Each thread takes Σ weight(i) parts in all.
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
  run_region(std::ref(of_thread));
}
/// As above, with weight 1 for every item.
template <class F>
void for_each_share(Index items, F&& f) {
  for_each_share(
      items, [](Index) { return Index{1}; }, f);
}
/// As above, for matrices: calls f(i, share) for i = 0 ... matrices.size() - 1.
template <class Matrices, class F>
void for_shares_of(const Matrices& matrices, F&& f) {
  for_each_share(static_cast<Index>(matrices.size()),
                 [&](Index i, Share share, int) { f(static_cast<std::size_t>(i), share); });
}

/// Calls f(item, rows, block) for every item 0 ... items - 1 and every block of the rows of n x n
/// matrices, and returns when all calls are done.  With one thread the items of one block follow
/// one another, so that their common terms stay in cache.  f must not throw.
template <class F>
void for_each_block(std::size_t items, Index n, F&& f) {
  const Index blocks = sum_blocks(n);
  const auto count = static_cast<Index>(items);
  const auto call = [&](Index item, Index block) {
    f(static_cast<std::size_t>(item), rows_of_share(n, {block, block + 1, blocks}), block);
  };
  if (current_threads == 1) {
    for (Index block = 0; block < blocks; ++block) {
      for (Index item = 0; item < count; ++item) call(item, block);
    }
    return;
  }
  auto of_thread = [&](int thread, int threads) {
    const Index all = count * blocks;
    for (Index k = thread * all / threads; k < (thread + 1) * all / threads; ++k) {
      call(k / blocks, k % blocks);
    }
  };
  run_region(std::ref(of_thread));
}

}  // namespace parallel
}  // namespace isosyrk
