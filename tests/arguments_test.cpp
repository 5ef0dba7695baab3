// Counts of steps, messages, and the ends of programs.  Which values are refused is tested from
// outside; see tests/scripts/test_integrate.py.
#include "benchmarks/arguments.h"

#include <new>

#include "benchmarks/program.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(StepCount, IsAWholeNumberToOnePartInABillion) {
  EXPECT_EQ(step_count(5.0, 0.1), 50);
  EXPECT_EQ(step_count(0.0, 0.1), 0);
  EXPECT_EQ(step_count(0.3, 0.1), 3);
  EXPECT_EQ(step_count(1.0 + 1e-11, 0.1), 10);
  EXPECT_EQ(step_count(1e5, 0.1), 1000000);
  for (const auto& [time, h] :
       {std::pair(1.0 + 1e-8, 0.1), {5.0, 0.3}, {0.01, 0.1}, {1e300, 1e-300}, {1e20, 1.0}}) {
    EXPECT_THROW(step_count(time, h), BadArgument) << time;
  }
}

TEST(PrintError, IsOneLineWhateverTheMessage) {
  ::testing::internal::CaptureStderr();
  print_error("integrate", "--n '1\n2\r3\x1b[2J\x7f': not a whole number, \xC3\xA9");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "integrate: --n '1 2 3 [2J ': not a whole number, \xC3\xA9\n");
}

TEST(BackendChoice, TakesTheFasterByMeasurementUnlessAsked) {
  const BackendRates measured = choose_backend(std::nullopt, 17);
  ASSERT_EQ(measured.rates.size(), product_backends().size());
  for (std::size_t k = 0; k < measured.rates.size(); ++k) {
    EXPECT_GT(measured.rates[k], 0.0);
    const auto chosen = measured.chosen == product_backends()[0] ? 0U : 1U;
    EXPECT_GE(measured.rates[chosen], measured.rates[k]);
  }
  EXPECT_EQ(choose_backend(ProductBackend::eigen, 17).chosen, ProductBackend::eigen);
  EXPECT_EQ(choose_backend(ProductBackend::openblas, 17).chosen, ProductBackend::openblas);
  EXPECT_EQ(choose_backend(ProductBackend::openblas, 4096).n, 257);
}

int fails(int, char**) { throw SolverFailed("some\nreason"); }
int ends_without_memory(int, char**) { throw std::bad_alloc(); }

// What a program that ends so prints and returns.
void expect_end(MainProgram& main_program, int exit_code, const std::string& printed) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run_program("some_program", main_program, 0, nullptr), exit_code);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), printed);
}

// Other ends are tested from outside.
TEST(Program, EndsWithOneLineWhereTheSolverOrTheMemoryFailed) {
  expect_end(fails, exit_solver_failed, "some_program: some reason\n");
  expect_end(ends_without_memory, exit_bad_arguments,
             "some_program: not enough memory for matrices of this size; n or stages must be "
             "smaller\n");
}

}  // namespace
}  // namespace isosyrk::testing
