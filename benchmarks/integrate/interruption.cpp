#include "benchmarks/integrate/interruption.h"

#include <csignal>
#include <initializer_list>

namespace isosyrk {
namespace {

// All that the handler touches: setting it is safe in the middle of anything.
volatile std::sig_atomic_t caught = 0;

void note(int number) { caught = number; }

}  // namespace

void watch_signals() {
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction action = {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // as under nohup, or in the background
    action = {};
    action.sa_handler = note;
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    sigaction(number, &action, nullptr);
  }
}

int caught_signal() { return caught; }

void end_if_interrupted() {
  if (caught != 0) throw Interrupted();
}

}  // namespace isosyrk
