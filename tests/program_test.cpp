#include "benchmarks/program.h"

#include <gtest/gtest.h>

#include <new>

namespace isosyrk::testing {
namespace {

template <class Error>
int ends_with_two_lines(int, char**) {
  throw Error("some\nreason");
}
int ends_without_memory(int, char**) { throw std::bad_alloc(); }
int ends_with_3(int, char**) { return exit_solver_failed; }

// What a program that ends so prints and returns.
void expect_end(MainProgram& main_program, int exit_code, const std::string& printed) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run_program("some_program", main_program, 0, nullptr), exit_code);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), printed);
}

TEST(Program, ExitCodeTellsWhetherTheSolverFailedOrAnythingElse) {
  const std::string line = "some_program: some reason\n";
  expect_end(ends_with_two_lines<SolverFailed>, exit_solver_failed, line);
  expect_end(ends_with_two_lines<BadArgument>, exit_bad_arguments, line);
  expect_end(ends_with_two_lines<std::invalid_argument>, exit_bad_arguments, line);
  expect_end(ends_without_memory, exit_bad_arguments,
             "some_program: not enough memory for matrices of this size; n or stages must be "
             "smaller\n");
  expect_end(ends_with_3, exit_solver_failed, "");
}

}  // namespace
}  // namespace isosyrk::testing
