// What a process is told of the memory that is left.
#include "isosyrk/machine/memory.h"

#include <sys/resource.h>

#include <cmath>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// The folder is a tree as the kernel shows it.
class AvailableMemory : public WithFolder {
 protected:
  AvailableMemory() { write("proc/meminfo", "MemTotal: 2000 kB\nMemAvailable:    1000 kB\n"); }

  void expect(double bytes, const std::string& source) const {
    const MemoryLimit limit = available_memory(folder_);
    EXPECT_EQ(limit.bytes, bytes);
    EXPECT_EQ(limit.source, source);
  }
};

TEST_F(AvailableMemory, IsThatOfTheMachineWithoutOtherLimits) {
  expect(1024000.0, "the machine");
  write("proc/self/cgroup", "0::/a/b\n");
  write("sys/fs/cgroup/a/b/memory.max", "max\n");
  write("sys/fs/cgroup/a/b/memory.current", "5000\n");
  expect(1024000.0, "the machine");
}

TEST_F(AvailableMemory, IsThatOfACgroupOrOfOneAboveIt) {
  write("proc/self/cgroup", "0::/a/b\n");
  write("sys/fs/cgroup/a/memory.max", "9000\n");
  write("sys/fs/cgroup/a/memory.current", "5000\n");
  expect(4000.0, "the cgroup");
  write("sys/fs/cgroup/a/b/memory.max", "7000\n");
  write("sys/fs/cgroup/a/b/memory.current", "5000\n");
  expect(2000.0, "the cgroup");
  write("sys/fs/cgroup/a/b/memory.stat", "anon 1000\nactive_file 1500\ninactive_file 500\n");
  expect(4000.0, "the cgroup");
  write("sys/fs/cgroup/a/b/memory.current", "9000\n");  // above its limit
  expect(0.0, "the cgroup");
}

TEST_F(AvailableMemory, IsThatOfACgroupOfVersion1) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/c\n4:memory:/m\n");
  write("sys/fs/cgroup/memory/m/memory.limit_in_bytes", "9000\n");
  write("sys/fs/cgroup/memory/m/memory.usage_in_bytes", "5000\n");
  write("sys/fs/cgroup/memory/m/memory.stat", "total_active_file 10\ntotal_inactive_file 20\n");
  expect(4030.0, "the cgroup");
}

TEST_F(AvailableMemory, IsUnlimitedWhereNothingIsKnown) {
  std::filesystem::remove_all(folder_);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &limit), 0);
  if (limit.rlim_cur != RLIM_INFINITY) GTEST_SKIP() << "the tests have a limit themselves";
  EXPECT_TRUE(std::isinf(available_memory(folder_).bytes));
}

}  // namespace
}  // namespace isosyrk::testing
