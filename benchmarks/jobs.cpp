#include "benchmarks/jobs.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>

namespace isosyrk {

using Json = nlohmann::ordered_json;

std::vector<Json> run_jobs(std::size_t count, long threads,
                           const std::function<Json(std::size_t)>& job,
                           const std::function<void(std::size_t)>& finished) {
  std::vector<Json> results(count);
  std::mutex mutex;  // of all below, and of finished()
  std::size_t next = 0;
  std::exception_ptr failure;
  const auto take_jobs = [&] {
    std::unique_lock lock(mutex);
    while (next < count) {
      const std::size_t k = next++;
      lock.unlock();
      try {
        results[k] = job(k);
        lock.lock();
        finished(k);
      } catch (...) {
        if (!lock.owns_lock()) lock.lock();
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (long t = 1; t < std::min(threads, static_cast<long>(count)); ++t) {
      others.emplace_back(take_jobs);
    }
    take_jobs();
  }
  if (failure) std::rethrow_exception(failure);
  return results;
}

}  // namespace isosyrk
