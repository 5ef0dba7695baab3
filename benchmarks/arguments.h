// Reading the values of a command line strictly: one line on an error, naming the argument, the
// value and what is allowed.
#pragma once

#include <limits>
#include <string>

#include "benchmarks/product_rate.h"
#include "benchmarks/program.h"

namespace isosyrk {

/// A whole number in [least, most].  Throws BadArgument.
long whole_number(const std::string& option, const std::string& text, long least, long most);

/// A finite real number in [least, most].  Throws BadArgument, saying that it must be `allowed`.
double real_number(const std::string& option, const std::string& text, const std::string& allowed,
                   double least = std::numeric_limits<double>::lowest(),
                   double most = std::numeric_limits<double>::max());
/// The least number that is positive.
inline constexpr double positive = std::numeric_limits<double>::denorm_min();

/// T / h as a whole number of steps, to 1e-9.  Throws BadArgument.
long step_count(double time, double step);

/// A number of threads, 1 to 64.  Throws BadArgument.
int thread_count(const std::string& option, const std::string& text);
/// Says on stderr if these are more threads than this process may run on at once, which is allowed.
void note_more_threads_than_cores(const char* program, int threads);

/// Returns what `read` returns.  Throws BadArgument for a std::invalid_argument, whose message
/// begins with the name of the option, without dashes.
template <class Read>
auto of_option(Read&& read) {
  try {
    return read();
  } catch (const std::invalid_argument& error) {
    throw BadArgument(std::string("--") + error.what());
  }
}

/// One of scene_names().  Throws BadArgument.
void require_scene(const std::string& option, const std::string& text);

/// Throws BadArgument if what was printed on stdout could not be written.
void require_printed();

}  // namespace isosyrk
