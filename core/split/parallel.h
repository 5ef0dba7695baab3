// All parallelism of the library.  The operations of this room share their work among OpenMP
// threads.
//
// The work of an operation is cut into fixed blocks, and each block is taken by whichever thread is
// free: a thread that is slow, or that comes late, takes fewer.  The blocks depend on n only, and
// sums over blocks are formed in the order of the blocks.  So the answer is the same bit for bit by
// every number of threads.
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

/// Largest number of threads.
inline constexpr int most_threads = 64;
/// Returns `threads`, or throws std::invalid_argument unless 1 <= threads <= most_threads.
int checked_threads(int threads);

namespace parallel {
// on_threads, which passes a reference: a std::function of that allocates nothing.
void run_on_threads(int threads, const std::function<void()>& body);
}  // namespace parallel

/// Calls body() on the present thread, and shares the operations of this room that it calls among
/// `threads` threads, or fewer if OpenMP has no more.  The others wait for operations until body()
/// returns: there is one parallel region, however many operations.  A call within another takes
/// the threads of that.  All threads treat denormal numbers as 0 (DenormalMode).  What body()
/// throws is thrown on.  Allocates nothing.  Throws as checked_threads.
template <class Body>
void on_threads(int threads, Body&& body) {
  parallel::run_on_threads(threads, std::ref(body));
}

/// What operations took, in seconds that passed.
struct OperationTimes {
  long operations = 0;
  double within = 0.0;  ///< in operations
  double busy = 0.0;    ///< of that, in their blocks, summed over the threads
};
/// Adds what operations take, that the present thread calls, to `times` from now on; null ends it.
/// A few clock readings an operation, so for measurements.
void measure_operations(OperationTimes* times);

namespace parallel {

class Team;

/// The team that shares the operations of this thread; null if it is alone.
inline constinit thread_local Team* own_team = nullptr;
/// Where operations of this thread are measured; null if they are not.
inline constinit thread_local OperationTimes* times = nullptr;

/// Returns the number of threads that share operations of the present thread.
int current_threads();

/// A block of an operation, and the operation that it is of.
using Block = void (*)(const void* operation, Index block, int thread);
// Calls block(operation, k, thread) for k = 0 ... blocks - 1, each once, on any thread of the team.
void share(Index blocks, Block block, const void* operation);

/// Calls f(block, thread) for block = 0 ... blocks - 1, each once, on whichever thread is free, and
/// returns when all calls are done.  One thread calls in order.  f must not throw.
template <class F>
void for_blocks(Index blocks, const F& f) {
  if (times == nullptr && (own_team == nullptr || blocks < 2)) {
    for (Index block = 0; block < blocks; ++block) f(block, 0);
    return;
  }
  share(
      blocks,
      [](const void* operation, Index block, int thread) {
        (*static_cast<const F*>(operation))(block, thread);
      },
      &f);
}

/// Upper bound of blocks_of(n).
inline constexpr Index most_blocks = 64;
/// Returns the number of blocks of rows into which work on an n x n matrix is cut.
inline Index blocks_of(Index n) {
  constexpr Index rows_of_block = 16;
  if (n < 3 * rows_of_block) return 1;
  return n / rows_of_block < most_blocks ? n / rows_of_block : most_blocks;
}

/// Rows begin ... end - 1.
struct Rows {
  Index begin;
  Index end;
};
/// Returns the rows of a share of n rows.
inline Rows rows_of_share(Index n, Share share) {
  return {n * share.first / share.parts, n * share.end / share.parts};
}

/// Calls f(item, rows, block) for every item 0 ... items - 1 and every block of the rows of n x n
/// matrices.  The items of one block follow one another, so that their common terms stay in cache.
/// f must not throw.
template <class F>
void for_each_block(std::size_t items, Index n, const F& f) {
  const Index blocks = blocks_of(n);
  const auto count = static_cast<Index>(items);
  for_blocks(count * blocks, [&](Index k, int) {
    const Index block = k / count;
    f(static_cast<std::size_t>(k % count), rows_of_share(n, {block, block + 1, blocks}), block);
  });
}

/// Calls f(item, share) for shares that together cover the n x n matrices 0 ... items - 1.  One
/// thread takes each as a whole.  f must not throw.
template <class F>
void for_each_share(std::size_t items, Index n, const F& f) {
  const Index parts = current_threads() == 1 ? 1 : blocks_of(n);
  for_blocks(static_cast<Index>(items) * parts, [&](Index k, int) {
    f(static_cast<std::size_t>(k / parts), Share{k % parts, k % parts + 1, parts});
  });
}
/// As above, for some matrices.
template <class Matrices, class F>
void for_shares_of(const Matrices& matrices, const F& f) {
  if (matrices.size() > 0) for_each_share(matrices.size(), matrices[0].size(), f);
}

}  // namespace parallel
}  // namespace isosyrk
