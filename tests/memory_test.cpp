// What a process is told of the memory that is left.
#include "isosyrk/machine/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

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

// The address space that a process may have, until it goes.
class AddressSpace {
 public:
  AddressSpace() { getrlimit(RLIMIT_AS, &before_); }
  ~AddressSpace() { setrlimit(RLIMIT_AS, &before_); }
  AddressSpace(const AddressSpace&) = delete;
  AddressSpace& operator=(const AddressSpace&) = delete;
  bool is_limited() const { return before_.rlim_cur != RLIM_INFINITY; }
  void limit(double bytes) const {
    rlimit to = before_;
    to.rlim_cur = static_cast<rlim_t>(bytes);
    ASSERT_EQ(setrlimit(RLIMIT_AS, &to), 0);
  }

 private:
  rlimit before_{};
};

double size_of_this_process() {
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// At n = 4096 a matrix has 268 MB, and a run needs several beside its integrator.
TEST(RequireMemory, CountsStatesBesideTheIntegrator) {
  constexpr double gigabyte = 1e9;
  constexpr Index n = 4096;
  const IntegratorEntry rk4 = integrator_entry("rk4");
  const AddressSpace space;
  const double size = size_of_this_process();
  if (size == 0.0 || size > 1e3 * gigabyte) GTEST_SKIP() << "a sanitizer reserves address space";
  if (space.is_limited()) GTEST_SKIP() << "the tests have a limit themselves";
  const double of_integrator = integrator_bytes(rk4, n);
  if (available_memory().bytes < of_integrator + 3.0 * gigabyte)
    GTEST_SKIP() << "too little memory";
  space.limit(size + of_integrator + 1.0 * gigabyte);
  expect_refused([&] { require_memory("--n 4096", rk4, n); }, "needs");
  space.limit(size + of_integrator + 3.0 * gigabyte);
  EXPECT_NO_THROW(require_memory("--n 4096", rk4, n));
}

}  // namespace
}  // namespace isosyrk::testing
