#include "benchmarks/peak.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>

namespace isosyrk::testing {
namespace {

// Leaves this thread, and those it starts, the first processor of those it had.
class OneProcessor {
 public:
  OneProcessor() {
    CPU_ZERO(&had_);
    sched_getaffinity(0, sizeof had_, &had_);
    int first = 0;
    while (!CPU_ISSET(first, &had_)) ++first;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(first, &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneProcessor() { sched_setaffinity(0, sizeof had_, &had_); }

 private:
  cpu_set_t had_;
};

TEST(CoresAtOnce, AreOneForTwoThreadsOnOneProcessor) {
  const OneProcessor one;
  double least = cores_at_once();
  for (int again = 0; again < 2; ++again) least = std::min(least, cores_at_once());
  EXPECT_GT(least, 0.0);
  EXPECT_LT(least, 1.3);  // others may have work here too
}

}  // namespace
}  // namespace isosyrk::testing
