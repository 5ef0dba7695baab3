#include "benchmarks/thread_settings.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace isosyrk {
namespace {

// Spins after a parallel region, of some 40 ns each, by default 300 000.  A step is one region, so
// little depends on it: four steps of group2, n = 257, take 0.80 s of CPU time by two threads on
// idle cores, by default 0.91 s, by one thread 0.71 s; beside one busy process on each core 1.19 s,
// by default 1.22 s, by one thread 0.85 s.
constexpr const char* spins = "1500";

// Returns true if the variable was anything else.
bool set(const char* name, std::string_view value) {
  const char* before = std::getenv(name);
  if (before != nullptr && value == before) return false;
  setenv(name, value.data(), 1);
  return true;
}

}  // namespace

void restart_with_thread_settings(char** argv) {
  bool differs = set("OPENBLAS_NUM_THREADS", "1");
  if (std::getenv("GOMP_SPINCOUNT") == nullptr && std::getenv("OMP_WAIT_POLICY") == nullptr) {
    differs = set("GOMP_SPINCOUNT", spins) || differs;
  }
  if (differs) execv("/proc/self/exe", argv);
}

}  // namespace isosyrk
