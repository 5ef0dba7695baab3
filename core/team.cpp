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
  second_.join();
}

void Team::begin(std::size_t count, void* context, Call call) {
  if (count == 0) return;
  context_ = context;
  call_ = call;
  done_.store(0, std::memory_order_relaxed);
  const std::uint32_t round = round_.load(std::memory_order_relaxed) + 1;
  ticket_.store((std::uint64_t{round} << 32) | std::uint64_t{count}, std::memory_order_release);
  round_.store(round, std::memory_order_release);
  round_.notify_one();
  take_tasks(round, 0);
  for (std::uint32_t done = done_.load(std::memory_order_acquire); done < count;
       done = done_.load(std::memory_order_acquire)) {
    wait_while(done_, done);
  }
}

void Team::take_tasks(std::uint32_t round, std::size_t thread) {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  for (;;) {
    const std::uint64_t front = (ticket >> 16) & 0xFFFF;
    const std::uint64_t back = ticket & 0xFFFF;
    if (ticket >> 32 != round || front >= back) return;
    const std::uint64_t rest = thread == 0 ? ticket + (1 << 16) : ticket - 1;
    if (!ticket_.compare_exchange_weak(ticket, rest, std::memory_order_acq_rel)) continue;
    call_(context_, thread == 0 ? front : back - 1, thread);
    done_.fetch_add(1, std::memory_order_release);
    done_.notify_one();
    ticket = ticket_.load(std::memory_order_acquire);
  }
}

void Team::second_thread() {
  const FlushDenormals flush;
  std::uint32_t seen = 0;
  for (;;) {
    wait_while(round_, seen);
    seen = round_.load(std::memory_order_acquire);
    if (ends_.load()) return;
    take_tasks(seen, 1);
  }
}

}  // namespace isosyrk
