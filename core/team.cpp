#include "core/team.h"

#include <fmt/format.h>

#include <stdexcept>

#include "core/flush_denormals.h"

namespace isosyrk {
namespace {

// Waits until `value` is another than `old`.  Between the products of a step lie some ten to a
// hundred microseconds, and to be woken takes as long: so for about that time it stays awake, but
// offers its core to whoever wants it; then it sleeps.
void wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  constexpr int offers = 400;
  for (int offer = 0; offer < offers; ++offer) {
    for (int look = 0; look < 16; ++look) {
      if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }
    std::this_thread::yield();
  }
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
  left_.store({round, 0, static_cast<std::uint8_t>(items.whole()), {0, 0}},
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
  const std::size_t whole = whole_.load(std::memory_order_relaxed);
  std::size_t item = 0;
  std::size_t phase = phases;  // of the item that is to be done next
  const auto do_phase = [&] {
    if (phase == phases) {
      if (!take_item(round, thread, item)) return false;
      phase = 0;
    }
    call_(context_, phase, item, Share{}, thread);
    if (++phase == phases) finish_task();
    return true;
  };
  const bool halves = halved_.load(std::memory_order_relaxed) > 0;
  if (halves) {
    for (std::size_t k = 0; k < phases; ++k) {
      if (!take_half(round, k, thread, thread)) return;
      for (std::size_t turn = 0; turn < (whole + 1) / 2; ++turn) do_phase();
    }
  }
  while (do_phase()) {
  }
  if (halves) take_half(round, phases - 1, 1 - thread, thread);
}

bool Team::take_item(std::uint32_t round, std::size_t thread, std::size_t& item) {
  Left left = left_.load(std::memory_order_acquire);
  for (;;) {
    if (left.round != round || left.front == left.back) return false;
    Left rest = left;
    item = thread == 0 ? rest.front++ : --rest.back;
    if (left_.compare_exchange_weak(left, rest, std::memory_order_acq_rel)) return true;
  }
}

// Sees to it that a phase of a half is taken, when both halves of the one before are done: of which
// it does what nobody has begun.  Returns false where the round is over.
bool Team::take_half(std::uint32_t round, std::size_t phase, std::size_t half,
                     std::size_t thread) {
  for (;;) {
    const std::uint32_t done = tasks_done_.load(std::memory_order_acquire);
    Left left = left_.load(std::memory_order_acquire);
    if (left.round != round) return false;
    if (left.phase[half] > phase) return true;
    const bool ready = finished_[0].load(std::memory_order_acquire) >= phase &&
                       finished_[1].load(std::memory_order_acquire) >= phase;
    const std::size_t which = ready ? half : 1 - half;
    const std::size_t now = ready ? phase : phase - 1;
    if (left.phase[which] == now) {
      Left rest = left;
      ++rest.phase[which];
      if (!left_.compare_exchange_weak(left, rest, std::memory_order_acq_rel)) continue;
      const std::size_t whole = whole_.load(std::memory_order_relaxed);
      const std::size_t count = whole + halved_.load(std::memory_order_relaxed);
      const Share share{static_cast<std::ptrdiff_t>(which), 2};
      for (std::size_t item = whole; item < count; ++item) {
        call_(context_, now, item, share, thread);
      }
      finished_[which].store(now + 1, std::memory_order_release);
      finish_task();
    } else {
      wait_while(tasks_done_, done);
    }
  }
}

void Team::finish_task() {
  tasks_done_.fetch_add(1, std::memory_order_release);
  tasks_done_.notify_one();
}

void Team::second_thread() {
  const FlushDenormals flush;
  std::uint32_t seen = 0;
  for (;;) {
    wait_while(round_, seen);
    seen = round_.load(std::memory_order_acquire);
    if (ends_.load()) return;
    take_part(seen, 1);
  }
}

}  // namespace isosyrk
