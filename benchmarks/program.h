// What every program does: its main(), its exit codes, and one line for what goes wrong.
#pragma once

#include <stdexcept>
#include <string>

namespace isosyrk {

/// Exit codes of every program of the project.
enum ExitCode : int { exit_done = 0, exit_bad_arguments = 2, exit_solver_failed = 3 };
/// Plus the number of the signal that ended a program, as shells have it.
constexpr int exit_by_signal = 128;

/// A command line that cannot be used; what() is the line to print.
class BadArgument : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that did not converge where a program needs that it does; what() is the line to print.
class SolverFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints `program: message` on one line of stderr, control characters as spaces.
void print_error(const char* program, std::string message);

/// Takes the arguments of main() and returns its exit code.
using MainProgram = int(int argc, char** argv);

/// Runs a program and returns its exit code. BadArgument, std::invalid_argument, a lack of memory
/// and any other exception become one line on stderr and exit_bad_arguments, but SolverFailed
/// exit_solver_failed.
int run_program(const char* name, MainProgram& main_program, int argc, char** argv);

}  // namespace isosyrk
