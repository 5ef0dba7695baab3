// Two threads that share tasks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "core/share.h"

namespace isosyrk {

/// Things that two threads share out: the first half of those that stay whole to one, the second
/// half to the other, and the last ones, `halved`, in halves, a half to each.  Those that stay
/// whole are even in number.
struct Items {
  Items(std::size_t how_many) : Items(how_many, how_many % 2) {}  // NOLINT: as a number
  Items(std::size_t how_many, std::size_t in_halves) : count(how_many), halved(in_halves) {}

  std::size_t whole() const { return count - halved; }

  std::size_t count;
  std::size_t halved;
};

/// Runs tasks by one thread, or by two of which the calling one is the first.
///
/// The first takes tasks from the front and the second from the back, until they meet: so each
/// mostly works on what its cache holds from the last round, and a second thread that does not get
/// a core costs next to nothing: the first does its work.  Neither waits by spinning for longer
/// than some microseconds; then it sleeps.  The second flushes denormal numbers, as the fast forms
/// do in the first.  Not for use by two threads at a time.
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
    if (!second_.joinable()) {
      for (std::size_t index = 0; index < count; ++index) task(index, std::size_t{0});
      return;
    }
    begin(count, &task, [](void* context, std::size_t index, std::size_t thread) {
      (*static_cast<std::remove_reference_t<Task>*>(context))(index, thread);
    });
  }

  /// Calls half(item, share, thread) for both halves of all items, likewise, each half where
  /// run_phases has its item; by one thread too.
  template <class OfHalf>
  void run_halves(Items items, OfHalf&& half) {
    run(2 * items.count, [&](std::size_t index, std::size_t thread) {
      const std::size_t before = items.whole() / 2 * 2;  // as many halves as there are in front
      if (index < before) {
        half(index / 2, half_of(index % 2), thread);
      } else if (index < before + 2 * items.halved) {
        in_the_middle(items, index - before, thread, half);
      } else {
        const std::size_t behind = index - 2 * items.halved;
        half(behind / 2, half_of(behind % 2), thread);
      }
    });
  }

  /// Calls each phase(item, share, thread) for all items, in turn for each item: by one thread with
  /// the whole as its share; by two, those in the middle in halves, a phase of which begins once
  /// both threads have done the last one.  Nothing else waits, so a phase may read what was there
  /// before and what earlier phases made of its own item, not of others.
  template <class... Phases>
  void run_phases(Items items, Phases&&... phases) {
    const auto all = [&](std::size_t item, std::size_t thread) {
      (phases(item, Share{}, thread), ...);
    };
    if (threads() == 1) {
      for (std::size_t item = 0; item < items.count; ++item) all(item, 0);
    } else {
      run_two(items, all, phases...);
    }
  }

 private:
  using Call = void (*)(void* context, std::size_t index, std::size_t thread);

  static Share half_of(std::size_t which) { return {static_cast<std::ptrdiff_t>(which), 2}; }

  // One of the halves of the items in the middle: the first halves, then the second ones.
  template <class OfHalf>
  static void in_the_middle(Items items, std::size_t index, std::size_t thread, OfHalf&& half) {
    if (index < items.halved) {
      half(items.whole() + index, half_of(0), thread);
    } else {
      half(items.count - 1 - (index - items.halved), half_of(1), thread);
    }
  }

  // The phases of the items in the middle, and with the last one all of the others.
  template <class All, class Phase, class... Rest>
  void run_two(Items items, const All& all, Phase&& phase, Rest&&... rest) {
    if constexpr (sizeof...(rest) > 0) {
      run(2 * items.halved, [&](std::size_t index, std::size_t thread) {
        in_the_middle(items, index, thread, phase);
      });
      run_two(items, all, rest...);
    } else {
      run(items.count + items.halved, [&](std::size_t index, std::size_t thread) {
        const std::size_t before = items.whole() / 2;
        if (index < before) {
          all(index, thread);
        } else if (index < before + 2 * items.halved) {
          in_the_middle(items, index - before, thread, phase);
        } else {
          all(index - 2 * items.halved, thread);
        }
      });
    }
  }

  void begin(std::size_t count, void* context, Call call);
  void take_tasks(std::uint32_t round, std::size_t thread);
  void second_thread();

  void* context_ = nullptr;
  Call call_ = nullptr;
  // Round, first task that is left, and the one behind the last: one word, so that a task of a
  // round that is over cannot be taken.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> round_{0};
  std::atomic<std::uint32_t> done_{0};
  std::atomic<bool> ends_{false};
  std::thread second_;
};

}  // namespace isosyrk
