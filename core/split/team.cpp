#include "isosyrk/split/team.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <stdexcept>

#include "isosyrk/split/flush_denormals.h"

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

void Team::run_two(Items items, const HalvesOf& halves_of, void* context, Call call) {
  if (items.count == 0) return;
  context_ = context;
  call_ = call;
  phases_.store(halves_of.phases, std::memory_order_relaxed);
  whole_.store(items.whole(), std::memory_order_relaxed);
  halved_.store(items.halved, std::memory_order_relaxed);
  std::size_t tasks = items.whole();
  std::array<HalfLeft, 2> left;
  const std::uint32_t round = round_.load(std::memory_order_relaxed) + 1;
  for (const std::size_t half : {0, 1}) {
    const std::uint32_t with_work = items.halved > 0 ? halves_of.with_work[half] : 0;
    with_work_[half].store(with_work, std::memory_order_relaxed);
    finished_[half].store(0, std::memory_order_relaxed);
    left[half] = {round, first_phase(with_work)};
    tasks += static_cast<std::size_t>(std::popcount(with_work));
  }
  const std::uint32_t before = tasks_done_.load(std::memory_order_relaxed);
  for (const std::size_t half : {0, 1}) {
    half_left_[half].store(left[half], std::memory_order_release);
  }
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
  for (;;) {
    const std::uint32_t done = tasks_done_.load(std::memory_order_acquire);
    const Taken own = take_half(round, thread, thread, looks_before_other_work);
    if (own == Taken::all) break;
    if (own == Taken::now || do_phase()) continue;
    // The other has not done what is before, or not even begun it.
    if (take_half(round, other, thread, 0) != Taken::now) wait_while(tasks_done_, done);
  }
  while (do_phase()) {
  }
  while (take_half(round, other, thread, 0) == Taken::now) {
  }
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

// Of those in which a half has work, the first phase.
std::uint32_t Team::first_phase(std::uint32_t with_work) {
  return with_work == 0 ? no_phase : static_cast<std::uint32_t>(std::countr_zero(with_work));
}

// Whether both halves have done what they have to do before a phase.
bool Team::is_ready(std::uint32_t phase) const {
  const std::uint32_t before = (std::uint32_t{1} << phase) - 1;
  for (const std::size_t half : {0, 1}) {
    const std::uint32_t with_work = with_work_[half].load(std::memory_order_relaxed);
    const auto last = static_cast<std::uint32_t>(std::bit_width(with_work & before));
    if (finished_[half].load(std::memory_order_acquire) < last) return false;
  }
  return true;
}

// Does the next phase of a half of the halved items if nobody has taken it and all is done that it
// waits for, at once or after so many more looks.  Who comes late may read here what is there of
// the next round, but then finds its own to be over before anything is taken.
Team::Taken Team::take_half(std::uint32_t round, std::size_t half, std::size_t thread, int looks) {
  HalfLeft left = half_left_[half].load(std::memory_order_acquire);
  for (int look = 0; left.round == round && left.phase != no_phase;) {
    if (!is_ready(left.phase)) {
      if (look++ == looks) return Taken::not_yet;
      pause();
      left = half_left_[half].load(std::memory_order_acquire);
      continue;
    }
    const std::uint32_t with_work = with_work_[half].load(std::memory_order_relaxed);
    const std::uint32_t phase = left.phase;
    const std::uint32_t later = with_work & ~((std::uint32_t{2} << phase) - 1);
    const HalfLeft rest{round, first_phase(later)};
    if (!half_left_[half].compare_exchange_weak(left, rest, std::memory_order_acq_rel)) continue;
    const bool divided = (with_work_[1 - half].load(std::memory_order_relaxed) >> phase & 1) != 0;
    const Share share = divided ? Share{static_cast<std::ptrdiff_t>(half), 2} : Share{};
    const std::size_t whole = whole_.load(std::memory_order_relaxed);
    const std::size_t count = whole + halved_.load(std::memory_order_relaxed);
    for (std::size_t item = whole; item < count; ++item) {
      call_(context_, phase, item, share, thread);
    }
    finished_[half].store(phase + 1, std::memory_order_release);
    finish_task();
    return Taken::now;
  }
  return Taken::all;
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
