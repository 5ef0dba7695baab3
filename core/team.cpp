#include "core/team.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "core/flush_denormals.h"

namespace isosyrk {
namespace {

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

// So long, a few microseconds, is it left to what the cache holds; other work takes longer.
constexpr int looks_before_other_work = 64;

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Whether somebody else wanted the core of a thread that waited.
enum class Core { free, wanted };

// Waits until `value` is another than `old`, for 10 ms at most, or until its core is wanted.  It
// stays awake, for longer than any part of a step takes: a core of a virtual machine that sleeps
// for a moment is given to others, and had back only after milliseconds.  But it offers its core to
// whoever wants it, and has learnt so when somebody took it for longer than a moment's work.
Core wait_awake(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  constexpr milliseconds longest(10);
  constexpr milliseconds moment(1);
  const auto until = steady_clock::now() + longest;
  for (;;) {
    for (int look = 0; look < 16; ++look) {
      if (value.load(std::memory_order_acquire) != old) return Core::free;
      pause();
    }
    const auto offered = steady_clock::now();
    std::this_thread::yield();
    const auto back = steady_clock::now();
    if (back - offered > moment) return Core::wanted;
    if (back > until) return Core::free;
  }
}

// Waits until `value` is another than `old`.
void wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  wait_awake(value, old);
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

Team::Team(int threads) {
  if (threads != 1 && threads != 2) {
    throw std::invalid_argument(fmt::format("threads: {}, must be 1 or 2", threads));
  }
  if (threads == 2) second_ = std::thread([this] { second_thread(); });
}

Team::~Team() {
  if (!second_.joinable()) return;
  ends_.store(true);
  round_.fetch_add(1);
  round_.notify_one();
  finish_task();  // a second thread may wait for one of a round that is over
  second_.join();
}

void Team::run_two(Items items, std::size_t phases, void* context, Call call) {
  if (items.count == 0) return;
  context_ = context;
  call_ = call;
  phases_.store(phases, std::memory_order_relaxed);
  whole_.store(items.whole(), std::memory_order_relaxed);
  halved_.store(items.halved, std::memory_order_relaxed);
  for (auto& half : finished_) half.store(0, std::memory_order_relaxed);
  const std::uint32_t tasks =
      static_cast<std::uint32_t>(items.whole() + (items.halved > 0 ? 2 * phases : 0));
  const std::uint32_t before = tasks_done_.load(std::memory_order_relaxed);
  const std::uint32_t round = round_.load(std::memory_order_relaxed) + 1;
  const std::uint32_t phases_left = items.halved > 0 ? 0 : static_cast<std::uint32_t>(phases);
  for (auto& half : half_left_) half.store({round, phases_left}, std::memory_order_release);
  whole_left_.store({round, 0, static_cast<std::uint16_t>(items.whole())},
                    std::memory_order_release);
  round_.store(round, std::memory_order_release);
  round_.notify_one();
  take_part(round, 0);
  for (std::uint32_t done = tasks_done_.load(std::memory_order_acquire); done - before < tasks;
       done = tasks_done_.load(std::memory_order_acquire)) {
    wait_while(tasks_done_, done);
  }
}

// Takes what is left of a round until all is taken.
void Team::take_part(std::uint32_t round, std::size_t thread) {
  const std::size_t phases = phases_.load(std::memory_order_relaxed);
  const std::size_t other = 1 - thread;
  std::size_t item = 0;
  std::size_t next = phases;  // phase of the item
  const auto do_phase = [&] {
    if (next == phases) {
      if (!take_item(round, thread, item)) return false;
      next = 0;
    }
    call_(context_, next, item, Share{}, thread);
    if (++next == phases) finish_task();
    return true;
  };
  const bool has_halves = halved_.load(std::memory_order_relaxed) > 0;
  if (has_halves) {
    for (std::size_t k = 0; k < phases; ++k) {
      for (;;) {
        const std::uint32_t done = tasks_done_.load(std::memory_order_acquire);
        if (take_half(round, k, thread, thread) != Taken::not_yet) break;
        if (do_phase()) continue;
        // Of the phase before, the other has not done its half, or not even begun it.
        if (take_half(round, k - 1, other, thread) == Taken::already) wait_while(tasks_done_, done);
      }
    }
  }
  while (do_phase()) {
  }
  if (has_halves) take_half(round, phases - 1, other, thread);
}

bool Team::take_item(std::uint32_t round, std::size_t thread, std::size_t& item) {
  WholeLeft left = whole_left_.load(std::memory_order_acquire);
  for (;;) {
    if (left.round != round || left.front == left.back) return false;
    WholeLeft rest = left;
    item = thread == 0 ? rest.front++ : --rest.back;
    if (whole_left_.compare_exchange_weak(left, rest, std::memory_order_acq_rel)) return true;
  }
}

// Does a phase of a half of the halved items if nobody has taken it and both halves have done the
// one before.
Team::Taken Team::take_half(std::uint32_t round, std::size_t phase, std::size_t half,
                            std::size_t thread) {
  const auto is_ready = [&] {
    return finished_[0].load(std::memory_order_acquire) >= phase &&
           finished_[1].load(std::memory_order_acquire) >= phase;
  };
  HalfLeft left = half_left_[half].load(std::memory_order_acquire);
  for (int look = 0; left.round == round && left.phase == phase; ++look) {
    if (!is_ready()) {
      if (look == looks_before_other_work) return Taken::not_yet;
      pause();
      left = half_left_[half].load(std::memory_order_acquire);
      continue;
    }
    const HalfLeft rest{round, static_cast<std::uint32_t>(phase + 1)};
    if (!half_left_[half].compare_exchange_weak(left, rest, std::memory_order_acq_rel)) continue;
    const std::size_t whole = whole_.load(std::memory_order_relaxed);
    const std::size_t count = whole + halved_.load(std::memory_order_relaxed);
    const Share share{static_cast<std::ptrdiff_t>(half), 2};
    for (std::size_t item = whole; item < count; ++item) {
      call_(context_, phase, item, share, thread);
    }
    finished_[half].store(phase + 1, std::memory_order_release);
    finish_task();
    return Taken::now;
  }
  return Taken::already;
}

void Team::finish_task() {
  tasks_done_.fetch_add(1, std::memory_order_release);
  tasks_done_.notify_one();
}

void Team::second_thread() {
  constexpr milliseconds shortest_rest(10), longest_rest(160);
  const FlushDenormals flush;
  milliseconds rest = shortest_rest;
  auto rested = steady_clock::now() - longest_rest;  // not lately
  for (std::uint32_t seen = 0; !ends_.load();) {
    if (wait_awake(round_, seen) == Core::wanted) {
      // The first does all meanwhile, rather than wait for what is begun here and not gone on with.
      rest = steady_clock::now() - rested < longest_rest ? std::min(2 * rest, longest_rest)
                                                         : shortest_rest;
      const auto until = steady_clock::now() + rest;
      while (steady_clock::now() < until && !ends_.load()) {
        std::this_thread::sleep_for(shortest_rest);
      }
      rested = steady_clock::now();
    }
    round_.wait(seen, std::memory_order_acquire);
    seen = round_.load(std::memory_order_acquire);
    if (!ends_.load()) take_part(seen, 1);
  }
}

}  // namespace isosyrk
