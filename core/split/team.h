// Two threads that share tasks.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <utility>

#include "isosyrk/split/share.h"

namespace isosyrk {

/// Things that two threads share out: the first half of those that stay whole to one, the second
/// half to the other, and the last ones, `halved`, in halves, a half to each.  Those that stay
/// whole are even in number; at most 32767 in all.
struct Items {
  Items(std::size_t how_many) : Items(how_many, how_many % 2) {}  // NOLINT: as a number
  Items(std::size_t how_many, std::size_t in_halves) : count(how_many), halved(in_halves) {}

  std::size_t whole() const { return count - halved; }

  std::size_t count;
  std::size_t halved;
};

/// A phase that is not done in halves where there are whole items too, on which the other thread
/// can work meanwhile: by `thread`, 0 or 1, or by the other if that has not begun it when it is
/// wanted.
template <class Phase>
struct Undivided {
  template <class Worker>
  void operator()(std::size_t item, Share share, Worker&& worker) {
    phase(item, share, worker);
  }

  std::size_t thread;
  Phase phase;
};
template <class Phase>
Undivided<Phase> undivided(std::size_t thread, Phase phase) {
  return {thread, std::move(phase)};
}

/// Runs tasks by one thread, or by two of which the calling one is the first.
///
/// The first takes whole items from the front and the second from the back, until they meet: so
/// each mostly works on what its cache holds from the last round.  Where the next phase of its
/// halves has to wait for the other's, it works on these; and when they are done, on what the other
/// has not yet begun.  Who has to wait stays awake for up to 10 ms, but offers its core to others
/// every microsecond or so.  If somebody else takes that of the second thread for more than 1 ms,
/// it rests for 10 ms, and twice as long as before where that comes within 160 ms of the last rest,
/// up to 160 ms: what it began and could not go on with would hold the first up.  So a second
/// thread without a core of its own costs little, some 5 %.  The second flushes denormal numbers,
/// as the fast forms do in the first.  Not for use by two threads at a time.
class Team {
 public:
  /// Throws std::invalid_argument unless threads is 1 or 2.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int threads() const { return second_.joinable() ? 2 : 1; }

  /// Calls task(index, thread) for every index below `count` <= 65535, in any order and by either
  /// thread, thread 0 or 1, and returns once all are done.  A task may not throw.
  template <class Task>
  void run(std::size_t count, Task&& task) {
    run_phases(Items(count, 0),
               [&](std::size_t index, Share, std::size_t thread) { task(index, thread); });
  }

  /// Calls half(item, share, thread) for both halves of all items, likewise, each half where
  /// run_phases has its item; by one thread too.
  template <class OfHalf>
  void run_halves(Items items, OfHalf&& half) {
    const std::size_t front = items.whole();  // halves of the first half of these
    const std::size_t back = front + 2 * items.halved;
    run(2 * items.count, [&](std::size_t index, std::size_t thread) {
      const auto of_two = [](std::size_t part) {
        return Share{static_cast<std::ptrdiff_t>(part), 2};
      };
      if (index < front) {
        half(index / 2, of_two(index % 2), thread);
      } else if (index < back) {  // first halves, then second ones
        const std::size_t part = (index - front) / items.halved;
        half(items.whole() + (index - front) % items.halved, of_two(part), thread);
      } else {
        half((index - back + front) / 2, of_two(index % 2), thread);
      }
    });
  }

  /// Calls each phase(item, share, thread) for all items, in turn for each item: by one thread with
  /// the whole as its share; by two, those in halves in halves, but for undivided phases, a phase
  /// of which begins once all of the last one is done.  Nothing else waits, so a phase may read
  /// what was there before and what earlier phases made of its own item, not of others.  At most 31
  /// phases.
  template <class... Phases>
  void run_phases(Items items, Phases&&... phases) {
    if (threads() == 1) {
      for (std::size_t item = 0; item < items.count; ++item) {
        (phases(item, Share{}, std::size_t{0}), ...);
      }
      return;
    }
    auto one_of_them = [&](std::size_t which, std::size_t item, Share share, std::size_t thread) {
      std::size_t k = 0;
      ((k++ == which ? static_cast<void>(phases(item, share, thread)) : void()), ...);
    };
    using OneOfThem = decltype(one_of_them);
    static_assert(sizeof...(Phases) < 32);
    HalvesOf halves_of;
    (halves_of.add(phases, items), ...);
    run_two(
        items, halves_of, &one_of_them,
        [](void* context, std::size_t which, std::size_t item, Share share, std::size_t thread) {
          (*static_cast<OneOfThem*>(context))(which, item, share, thread);
        });
  }

 private:
  // Does a phase of an item, or of a share of it.
  using Call = void (*)(void* context, std::size_t phase, std::size_t item, Share share,
                        std::size_t thread);

  // How many phases there are, and in which of them either half of the items in halves has work: in
  // bits, the first phase's the lowest.
  struct HalvesOf {
    template <class Phase>
    void add(const Phase&, Items) {
      add_to(true, true);
    }
    template <class Phase>
    void add(const Undivided<Phase>& undivided, Items items) {
      const bool divided = items.whole() == 0;
      add_to(divided || undivided.thread == 0, divided || undivided.thread == 1);
    }
    void add_to(bool first, bool second) {
      with_work[0] |= std::uint32_t{first} << phases;
      with_work[1] |= std::uint32_t{second} << phases;
      ++phases;
    }

    std::size_t phases = 0;
    std::array<std::uint32_t, 2> with_work{};
  };

  // What nobody has taken yet: whole items front ... back - 1, and of a half of the others the
  // phases from the given one on in which it has work.  With their round: nothing can be taken of
  // one that is over.  Aligned as one word, which not every compiler sees to by itself.
  struct alignas(8) WholeLeft {
    std::uint32_t round;
    std::uint16_t front;
    std::uint16_t back;
  };
  struct alignas(8) HalfLeft {
    std::uint32_t round;
    std::uint32_t phase;
  };
  static_assert(std::atomic<WholeLeft>::is_always_lock_free &&
                std::atomic<HalfLeft>::is_always_lock_free);
  static constexpr std::uint32_t no_phase = 32;
  enum class Taken { now, not_yet, all };

  void run_two(Items items, const HalvesOf& halves_of, void* context, Call call);
  void take_part(std::uint32_t round, std::size_t thread);
  bool take_item(std::uint32_t round, std::size_t thread, std::size_t& item);
  Taken take_half(std::uint32_t round, std::size_t half, std::size_t thread, int looks);
  bool is_ready(std::uint32_t phase) const;
  static std::uint32_t first_phase(std::uint32_t with_work);
  void finish_task();
  void second_thread();

  void* context_ = nullptr;
  Call call_ = nullptr;
  // Of the round under way; atomic, since who comes late may look at those of the next.
  std::atomic<std::size_t> phases_{0};
  std::atomic<std::size_t> whole_{0};
  std::atomic<std::size_t> halved_{0};
  std::array<std::atomic<std::uint32_t>, 2> with_work_{};
  std::atomic<WholeLeft> whole_left_{};
  std::array<std::atomic<HalfLeft>, 2> half_left_{};
  std::array<std::atomic<std::uint32_t>, 2> finished_{};  // by either half, up to this phase
  std::atomic<std::uint32_t> round_{0};
  std::atomic<std::uint32_t> tasks_done_{0};  // in all rounds
  std::atomic<bool> ends_{false};
  std::thread second_;
};

}  // namespace isosyrk
