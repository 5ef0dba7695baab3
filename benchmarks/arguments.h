// Reading the values of a command line strictly: one line on an error, naming the argument, the
// value and what is allowed.
#pragma once

#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "benchmarks/product_rate.h"
#include "core/scene.h"

namespace isosyrk {

/// Exit codes of every program of the project.
enum ExitCode : int { exit_done = 0, exit_bad_arguments = 2, exit_solver_failed = 3 };

/// A command line that cannot be used; what() is the line to print.
class BadArgument : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A whole number in [least, most].  Throws BadArgument.
long whole_number(const std::string& option, const std::string& text, long least, long most);

/// A finite real number.  Throws BadArgument, saying that it must be `allowed`.
double real_number(const std::string& option, const std::string& text, const std::string& allowed);

/// A number that is positive and finite.  Throws BadArgument.
double positive_number(const std::string& option, const std::string& text);

/// T / h as a whole number of steps, to 1e-9.  Throws BadArgument.
long step_count(double time, double step);

/// "paper" or "standard".  Throws BadArgument.
HbarConvention hbar_convention(const std::string& text);

/// One of scene_names().  Throws BadArgument.
void require_scene(const std::string& option, const std::string& text);

/// "fastest", "openblas" or "eigen".  Throws BadArgument.
BackendChoice backend_choice(const std::string& text);

/// Throws BadArgument if what was printed on stdout could not be written.
void require_printed();

/// Prints `program: message` on one line of stderr, control characters as spaces.
void print_error(const char* program, std::string message);

/// Runs a program's body and turns BadArgument, std::invalid_argument and a lack of memory into one
/// line on stderr and exit_bad_arguments.  `body` returns the exit code.
template <class Body>
int guarded(const char* program, Body&& body) {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    print_error(program,
                "not enough memory for matrices of this size; n or stages must be smaller");
    return exit_bad_arguments;
  } catch (const std::exception& error) {
    print_error(program, error.what());
    return exit_bad_arguments;
  }
}

}  // namespace isosyrk
