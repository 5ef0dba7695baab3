#include "isosyrk/machine/memory.h"

#include <cblas.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/linalg/products.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {
namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double megabyte = 1e6;

// The number behind a key in a file of words, or without a key the number that the file holds.
// None for "max" and for a file that is not there.
std::optional<double> number_in(const fs::path& file, const std::string& key = "") {
  std::ifstream input(file);
  std::string word;
  while (word != key && input >> word) {
  }
  double number = 0.0;
  if (input >> number) return number;
  return {};
}

// How the two versions of cgroups name their files.
struct CgroupFiles {
  const char* folder;
  const char* limit;
  const char* usage;
  const char* pages;  // before active_file and inactive_file in memory.stat
};
constexpr CgroupFiles version1 = {"memory", "memory.limit_in_bytes", "memory.usage_in_bytes",
                                  "total_"};
constexpr CgroupFiles version2 = {"", "memory.max", "memory.current", ""};

double available_in(const fs::path& cgroup, const CgroupFiles& files) {
  const auto limit = number_in(cgroup / files.limit);
  const auto usage = number_in(cgroup / files.usage);
  if (!limit || !usage) return unlimited;
  double pages = 0.0;
  for (const char* kind : {"active_file", "inactive_file"}) {
    pages += number_in(cgroup / "memory.stat", std::string(files.pages) + kind).value_or(0.0);
  }
  return std::max(0.0, *limit - std::max(0.0, *usage - pages));
}

// /proc/self/cgroup has lines number:controllers:path, no controllers for version 2.
double available_in_cgroups(const fs::path& root) {
  double least = unlimited;
  std::ifstream input(root / "proc/self/cgroup");
  std::string line;
  while (std::getline(input, line)) {
    const auto first = line.find(':');
    const auto second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    const bool is_memory = controllers.find(",memory,") != std::string::npos;
    if (!is_memory && controllers != ",,") continue;
    const CgroupFiles& files = is_memory ? version1 : version2;
    const fs::path top = root / "sys/fs/cgroup" / files.folder;
    fs::path path = fs::path(line.substr(second + 1)).relative_path();
    least = std::min(least, available_in(top, files));
    for (; !path.empty(); path = path.parent_path()) {
      least = std::min(least, available_in(top / path, files));
    }
  }
  return least;
}

double address_space_left(const fs::path& root) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  const double pages = number_in(root / "proc/self/statm").value_or(0.0);
  const double size = pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - size);
}

// Bytes that malloc has handed out, in all its arenas.
double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

// OpenBLAS takes its buffers at the first product that is not small, and those of its threads,
// which a fork takes away, when their number is set.
void take_buffers() {
  openblas_set_num_threads(openblas_get_num_threads());
  constexpr Index n = 64;
  const Matrix A = Matrix::Zero(n, n);
  Matrix C(n, n);
  Products(ProductBackend::openblas, n).multiply(A, A, C);
}

// Ends this process by a signal when it has taken more CPU time than thousands of products.
void end_soon() {
  constexpr itimerval longest = {{0, 0}, {0, 250'000}};
  sigset_t of_timer;
  sigemptyset(&of_timer);
  sigaddset(&of_timer, SIGPROF);
  std::signal(SIGPROF, SIG_DFL);
  sigprocmask(SIG_UNBLOCK, &of_timer, nullptr);
  setitimer(ITIMER_PROF, &longest, nullptr);
}

// Returns true if a copy of this process can take the buffers.  Where they find no room it tries
// for ever, and is ended.  It tells by a byte: its status is lost where SIGCHLD is ignored.
bool copy_can_take_buffers() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return true;  // not known
  const pid_t copy = fork();
  if (copy == 0) {
    end_soon();
    take_buffers();
    _exit(write(ends[1], "", 1) == 1 ? 0 : 1);
  }
  close(ends[1]);
  char told = 0;
  ssize_t count = copy == -1 ? 1 : -1;  // without a copy not known
  while (count == -1 && (count = read(ends[0], &told, 1)) == -1 && errno == EINTR) {
  }
  close(ends[0]);
  while (copy != -1 && waitpid(copy, nullptr, 0) == -1 && errno == EINTR) {
  }
  return count == 1;
}

}  // namespace

MemoryLimit available_memory(const fs::path& root) {
  constexpr double kilobyte = 1024.0;
  const auto of_machine = number_in(root / "proc/meminfo", "MemAvailable:");
  MemoryLimit least = {kilobyte * of_machine.value_or(unlimited), "the machine"};
  const MemoryLimit others[] = {
      {available_in_cgroups(root), "the cgroup"},
      {std::max(0.0, address_space_left(root)), "the limit of this process (ulimit -v)"}};
  for (const MemoryLimit& other : others) {
    if (other.bytes < least.bytes) least = other;
  }
  return least;
}

double integrator_bytes(const IntegratorEntry& integrator, Index n) {
  constexpr Index largest_made = 96;  // from here on fast forms have all their threads
  const Index made = std::min(n, largest_made);
  const auto flow = std::make_shared<const EulerZeitlin>(made);
  const double before = allocated_bytes();
  auto instance = integrator.make(flow, {}, ProductBackend::openblas);
  const double with = allocated_bytes();
  instance.reset();
  const double bytes = std::min(with - before, with - allocated_bytes());
  const auto entries = [](Index size) {
    return static_cast<double>(size) * static_cast<double>(split_row<double>(size));
  };
  return std::max(0.0, bytes) * entries(n) / entries(made);
}

void require_memory(const std::string& what, const IntegratorEntry& integrator, Index n) {
  // At most so many n x n complex matrices beside the integrator: states, spectra, output.
  constexpr double other_matrices = 8.0;
  constexpr double gigabyte = 1e9;
  require_memory_of_blas();
  const auto size = static_cast<double>(n);
  const double needed =
      integrator_bytes(integrator, n) + other_matrices * size * size * sizeof(Complex);
  const MemoryLimit limit = available_memory();
  if (needed <= limit.bytes) return;
  throw std::invalid_argument(fmt::format(
      "{}: needs {:.3g} GB of memory, and {} has {:.3g} GB left; n or stages must be smaller", what,
      needed / gigabyte, limit.source, limit.bytes / gigabyte));
}

void require_memory_of_blas() {
  constexpr double for_the_rest = 16.0 * megabyte;
  static std::atomic<bool> has_buffers = false;
  double left = address_space_left("/");
  if (left == unlimited) return;
  if (!has_buffers && copy_can_take_buffers()) {
    take_buffers();
    has_buffers = true;
    left = address_space_left("/");
  }
  if (has_buffers && left >= for_the_rest) return;
  throw std::invalid_argument(fmt::format(
      "OpenBLAS needs more address space for its buffers than the limit of this process "
      "(ulimit -v) leaves, {:.0f} MB; it must be higher",
      left / megabyte));
}

}  // namespace isosyrk
