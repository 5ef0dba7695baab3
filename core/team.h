// Two threads that share tasks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

namespace isosyrk {

/// Runs tasks by one thread, or by two of which the calling one is the first.
///
/// The first takes tasks from the front and the second from the back, until they meet: so each mostly
/// works on what its cache holds from the last round, and a second thread that does not get a core
/// costs next to nothing: the first does its work.  Neither waits by spinning for longer than some
/// microseconds; then it sleeps.  The second flushes denormal numbers, as the fast forms do in the
/// first.  Not for use by two threads at a time.
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

 private:
  using Call = void (*)(void* context, std::size_t index, std::size_t thread);

  void begin(std::size_t count, void* context, Call call);
  void take_tasks(std::uint32_t round, std::size_t thread);
  void second_thread();

  void* context_ = nullptr;
  Call call_ = nullptr;
  // Round, first task that is left, and the one behind the last: one word, so that a task of a round
  // that is over cannot be taken.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> round_{0};
  std::atomic<std::uint32_t> done_{0};
  std::atomic<bool> ends_{false};
  std::thread second_;
};

}  // namespace isosyrk
