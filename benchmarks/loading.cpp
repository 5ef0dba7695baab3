#include "benchmarks/loading.h"

#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>

#include "benchmarks/program.h"
#include "benchmarks/thread_settings.h"

namespace isosyrk {
namespace {

// Loading takes some milliseconds.
constexpr itimerval longest = {{0, 0}, {0, 250'000}};
constexpr itimerval none = {{0, 0}, {0, 0}};

char message[256];  // formed before the signal, in whose handler nothing may be formatted

// Forms the message and returns true, or returns false where there is no limit.
bool form_message(const char* program) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  constexpr double megabyte = 1e6;
  std::snprintf(message, sizeof message,
                "%s: OpenBLAS finds no room for its buffers in the address space, which is limited "
                "(ulimit -v) to %.0f MB; it must be higher\n",
                program, static_cast<double>(limit.rlim_cur) / megabyte);
  return true;
}

void give_up(int) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message, std::strlen(message));
  _exit(exit_bad_arguments);
}

}  // namespace

void guard_loading(const char* program, char** argv, char** environment) {
  if (!form_message(program)) return;
  environ = environment;  // the C library sets it only later
  restart_with_thread_settings(argv);
  std::signal(SIGPROF, give_up);
  sigset_t of_timer;
  sigemptyset(&of_timer);
  sigaddset(&of_timer, SIGPROF);
  sigprocmask(SIG_UNBLOCK, &of_timer, nullptr);
  setitimer(ITIMER_PROF, &longest, nullptr);
}

void end_guard_of_loading() {
  if (message[0] == '\0') return;
  setitimer(ITIMER_PROF, &none, nullptr);
  std::signal(SIGPROF, SIG_DFL);
}

}  // namespace isosyrk
