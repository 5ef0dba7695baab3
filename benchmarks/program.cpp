#include "benchmarks/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <new>

#include "isosyrk/machine/memory.h"

namespace isosyrk {

void print_error(const char* program, std::string message) {
  const auto is_control = [](unsigned char c) { return std::iscntrl(c) != 0; };
  std::replace_if(message.begin(), message.end(), is_control, ' ');
  std::fputs(fmt::format("{}: {}\n", program, message).c_str(), stderr);
}

int run_program(const char* name, MainProgram& main_program, int argc, char** argv) {
  try {
    require_memory_of_blas();
    return main_program(argc, argv);
  } catch (const std::bad_alloc&) {
    print_error(name, "not enough memory for matrices of this size; n or stages must be smaller");
  } catch (const SolverFailed& error) {
    print_error(name, error.what());
    return exit_solver_failed;
  } catch (const std::exception& error) {
    print_error(name, error.what());
  }
  return exit_bad_arguments;
}

}  // namespace isosyrk
