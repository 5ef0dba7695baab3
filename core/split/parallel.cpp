#include "isosyrk/split/parallel.h"

#include <fmt/format.h>
#include <omp.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <thread>

namespace isosyrk {
namespace parallel {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Tells the processor that this thread waits for another one.
void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

constexpr std::size_t cache_line = 64;

}  // namespace

/// The threads of a call of on_threads.  The first shares operations, and the others serve.
///
/// An operation is open while blocks are left to take.  One word holds its number and how many are
/// left, and a thread takes a block by counting that down.  So a thread that comes late, with the
/// description of an operation that is over, takes none of the next one by it.
class Team {
 public:
  int threads() const { return threads_; }
  /// Sets how many threads there are, before the first operation.
  void set_threads(int threads) { threads_ = threads; }

  /// Shares an operation, and returns when all its blocks are done.
  void share(Index blocks, Block block, const void* operation) {
    block_.store(block, std::memory_order_relaxed);
    operation_.store(operation, std::memory_order_relaxed);
    blocks_.store(blocks, std::memory_order_relaxed);
    is_timed_.store(times != nullptr, std::memory_order_relaxed);
    unfinished_.store(blocks, std::memory_order_relaxed);
    open(static_cast<std::uint64_t>(blocks));
    take_blocks(0);
    wait_for_all();
  }

  /// Takes blocks of operations until the team is closed.
  void serve(int thread) {
    for (;;) {
      const std::uint64_t seen = take_blocks(thread);
      if (is_closed_.load(std::memory_order_acquire)) return;
      wait_for_change(seen);
    }
  }

  void close() {
    is_closed_.store(true, std::memory_order_release);
    open(0);
  }

  /// Returns the seconds that blocks have taken, summed over the threads, when they are timed.
  double busy() const { return busy_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint64_t left_mask = 0xffffffff;

  // Numbers the next operation, of which so many blocks are left.
  void open(std::uint64_t left) {
    open_.store((++number_ << 32) | left, std::memory_order_release);
    open_.notify_all();
  }

  // Takes blocks while there are any.  Returns the word that said that there are no more.
  std::uint64_t take_blocks(int thread) {
    Index done = 0;
    Clock::time_point begin;
    bool is_timed = false;
    std::uint64_t word = open_.load(std::memory_order_acquire);
    while ((word & left_mask) > 0) {
      // Of the operation whose block is taken: the next one is not described before all are.
      const Block block = block_.load(std::memory_order_relaxed);
      const void* const operation = operation_.load(std::memory_order_relaxed);
      const Index blocks = blocks_.load(std::memory_order_relaxed);
      const bool timed = is_timed_.load(std::memory_order_relaxed);
      if (!open_.compare_exchange_weak(word, word - 1, std::memory_order_acq_rel)) continue;
      if (done == 0 && timed) {
        is_timed = true;
        begin = Clock::now();
      }
      block(operation, blocks - static_cast<Index>(word & left_mask), thread);
      ++done;
      word = open_.load(std::memory_order_acquire);
    }
    if (is_timed) busy_.fetch_add(seconds_since(begin), std::memory_order_relaxed);
    if (done > 0) unfinished_.fetch_sub(done, std::memory_order_release);
    return word;
  }

  // The last blocks are being done.  Where more threads than processors run, one of those that do
  // them may have to be let run.
  void wait_for_all() const {
    constexpr int before_yield = 2000;
    for (int k = 0; unfinished_.load(std::memory_order_acquire) > 0; ++k) {
      if (k < before_yield) {
        relax();
      } else {
        std::this_thread::yield();
      }
    }
  }

  // The next operation mostly follows soon.  A thread that sleeps takes tens of microseconds to
  // wake up, in which the others do its blocks.
  void wait_for_change(std::uint64_t seen) const {
    constexpr auto most = std::chrono::microseconds(200);
    constexpr int between_looks = 64;
    const Clock::time_point begin = Clock::now();
    while (Clock::now() - begin < most) {
      for (int k = 0; k < between_looks; ++k) {
        if (open_.load(std::memory_order_acquire) != seen) return;
        relax();
      }
    }
    open_.wait(seen, std::memory_order_acquire);
  }

  int threads_ = 1;
  std::uint64_t number_ = 0;  // of the operation
  alignas(cache_line) std::atomic<std::uint64_t> open_{0};
  std::atomic<bool> is_closed_{false};
  // Of the operation.
  alignas(cache_line) std::atomic<Block> block_{nullptr};
  std::atomic<const void*> operation_{nullptr};
  std::atomic<Index> blocks_{0};
  std::atomic<bool> is_timed_{false};
  alignas(cache_line) std::atomic<Index> unfinished_{0};
  std::atomic<double> busy_{0.0};
};

int current_threads() { return own_team == nullptr ? 1 : own_team->threads(); }

void share(Index blocks, Block block, const void* operation) {
  const bool is_shared = own_team != nullptr && blocks > 1;
  const double busy_before = is_shared ? own_team->busy() : 0.0;
  const Clock::time_point begin = times != nullptr ? Clock::now() : Clock::time_point();
  if (is_shared) {
    own_team->share(blocks, block, operation);
  } else {
    for (Index k = 0; k < blocks; ++k) block(operation, k, 0);
  }
  if (times == nullptr) return;
  const double within = seconds_since(begin);
  ++times->operations;
  times->within += within;
  times->busy += is_shared ? own_team->busy() - busy_before : within;
}

}  // namespace parallel

int checked_threads(int threads) {
  if (threads < 1 || threads > most_threads) {
    throw std::invalid_argument(
        fmt::format("threads = {}: must be 1 to {}", threads, most_threads));
  }
  return threads;
}

void measure_operations(OperationTimes* times) { parallel::times = times; }

void parallel::run_on_threads(int threads, const std::function<void()>& body) {
  checked_threads(threads);
  if (threads == 1 || parallel::own_team != nullptr) {
    const DenormalMode flushed(true);
    return body();
  }
  // OpenMP creates threads here.  They inherit the mode of this thread and keep it after the
  // region, so the mode is reset first.
  const DenormalMode as_numbers(false);
  parallel::Team team;
  std::exception_ptr thrown;
#pragma omp parallel num_threads(threads)
  {
    const DenormalMode flushed(true);
    const int thread = omp_get_thread_num();
    if (thread > 0) {
      team.serve(thread);
    } else {
      team.set_threads(omp_get_num_threads());
      parallel::own_team = &team;
      try {
        body();
      } catch (...) {
        thrown = std::current_exception();
      }
      parallel::own_team = nullptr;
      team.close();
    }
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace isosyrk
