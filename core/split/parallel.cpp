#include "isosyrk/split/parallel.h"

#include <fmt/format.h>
#include <omp.h>

#include <stdexcept>

namespace isosyrk {

int ThreadScope::checked(int threads) {
  if (threads < 1 || threads > most) {
    throw std::invalid_argument(
        fmt::format("threads = {}: must be 1 to {}", threads, int{ThreadScope::most}));
  }
  return threads;
}

ThreadScope::ThreadScope(int threads) : before_(parallel::current_threads) {
  parallel::current_threads = checked(threads);
}

ThreadScope::~ThreadScope() { parallel::current_threads = before_; }

namespace parallel {

void run_region(const std::function<void(int thread, int threads)>& body) {
  // OpenMP creates threads here.  They inherit the mode of this thread and keep it after the
  // region, so the mode is reset first.
  const DenormalMode as_numbers(false);
#pragma omp parallel num_threads(current_threads)
  {
    const DenormalMode flushed(true);
    body(omp_get_thread_num(), omp_get_num_threads());
  }
}

}  // namespace parallel
}  // namespace isosyrk
