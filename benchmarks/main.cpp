// main() of every program. ISOSYRK_PROGRAM, set by CMakeLists.txt, is the program's name and the
// namespace that holds its main_program(): so can several programs be compiled at a time.
#include "benchmarks/loading.h"
#include "benchmarks/program.h"
#include "benchmarks/thread_settings.h"

namespace isosyrk::ISOSYRK_PROGRAM {
MainProgram main_program;
}

#define ISOSYRK_TEXT_OF(name) #name
#define ISOSYRK_NAME_OF(program) ISOSYRK_TEXT_OF(program)

// Called before the constructors of libraries.
extern "C" {
static void before_libraries(int, char** argv, char** environment) {
  isosyrk::guard_loading(ISOSYRK_NAME_OF(ISOSYRK_PROGRAM), argv, environment);
}
[[gnu::section(".preinit_array"),
  gnu::used]] static void (*const first_of_all)(int, char**, char**) = before_libraries;
}

int main(int argc, char** argv) {
  isosyrk::end_guard_of_loading();
  isosyrk::restart_with_thread_settings(argv);
  return isosyrk::run_program(ISOSYRK_NAME_OF(ISOSYRK_PROGRAM),
                              isosyrk::ISOSYRK_PROGRAM::main_program, argc, argv);
}
