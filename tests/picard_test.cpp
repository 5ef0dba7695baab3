#include "isosyrk/iteration/picard.h"

#include <gtest/gtest.h>

#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();
const double infinity = std::numeric_limits<double>::infinity();

// The driver on a given sequence of changes; the last one repeats for ever.
SolveReport solve_changes(const std::vector<double>& changes, const SolverOptions& options = {}) {
  std::size_t next = 0;
  return solve_fixed_point(options, [&] { return changes[std::min(next++, changes.size() - 1)]; });
}

TEST(FixedPoint, ConvergesAtTheFirstChangeBelowTolerance) {
  const SolveReport report = solve_changes({1.0, 1e-5, 1e-13, 9e-14, 1e-20});
  EXPECT_EQ(report.status, Status::converged);
  EXPECT_EQ(report.sweeps, 4);  // a change equal to the tolerance is not below it
  EXPECT_EQ(report.change, 9e-14);
}

TEST(FixedPoint, DivergesOnLargeOrNonFiniteChange) {
  for (const double bad : {1.1e6, infinity, nan}) {
    const SolveReport report = solve_changes({1.0, bad, 0.0});
    EXPECT_EQ(report.status, Status::diverged);
    EXPECT_EQ(report.sweeps, 2);
  }
  EXPECT_EQ(solve_changes({1e6, 0.0}).status, Status::converged);
}

TEST(FixedPoint, StagnatesAfter50SweepsWithoutABetterChange) {
  const SolveReport report = solve_changes({1.0, 0.5, 0.5});
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_EQ(report.sweeps, 2 + 50);
}

TEST(FixedPoint, IsNotCalledStagnatedWhileItImprovesNowAndThen) {
  double change = 1.0;
  int sweep = 0;
  const SolveReport report = solve_fixed_point({1e-3, 1000}, [&] {
    if (++sweep % 50 == 0) change *= 0.5;
    return change;
  });
  EXPECT_EQ(report.status, Status::converged);
}

TEST(FixedPoint, ReportsTheSweepCapWhileStillFalling) {
  double change = 1.0;
  const SolveReport report = solve_fixed_point({1e-13, 20}, [&] { return change *= 0.9; });
  EXPECT_EQ(report.status, Status::sweep_cap);
  EXPECT_EQ(report.sweeps, 20);
}

TEST(FixedPoint, MeasuresTheContraction) {
  for (const double q : {0.2, 0.9}) {
    double change = 1.0;
    const SolveReport report = solve_fixed_point({}, [&] { return change *= q; });
    EXPECT_NEAR(report.contraction, q, 1e-12);
  }
  // Over the last five sweeps: (1e-14 / 1e-1)^(1/5), of a start that does not count any more.
  EXPECT_NEAR(solve_changes({5.0, 5.0, 1e-1, 1e-3, 1e-4, 1e-6, 1e-9, 1e-14}).contraction,
              std::pow(1e-13, 0.2), 1e-12);
  EXPECT_NEAR(solve_changes({1.0, 1e-14}).contraction, 1e-14, 1e-26);
  EXPECT_EQ(solve_changes({0.0}).contraction, 0.0);  // a single sweep tells nothing
  EXPECT_GT(solve_changes({1.0, 10.0, 1e7}).contraction, 1.0);
}

TEST(Attempt, HasANameOfItsOwn) {
  EXPECT_EQ(name(Attempt{}), "explicit");
  EXPECT_EQ(name({Start::cold, Iteration::picard}), "cold Picard");
  EXPECT_EQ(name({Start::predicted, Iteration::newton}), "predicted Newton");
  EXPECT_EQ(name({Start::cold, Iteration::frozen_picard}), "cold frozen Picard");
  EXPECT_EQ(name({Start::cold, Iteration::anderson}), "cold Anderson");
}

TEST(Larger, KeepsNanWhateverItsPlace) {
  EXPECT_EQ(larger(1.0, 2.0), 2.0);
  EXPECT_TRUE(std::isnan(larger(1.0, nan)));
  EXPECT_TRUE(std::isnan(larger(nan, 1.0)));
}

class SolverOf : public ::testing::TestWithParam<Method> {
 protected:
  const Formulation formulation = GetParam().formulation;
  const int s = GetParam().s;
  const Scene scene = smooth_scene(17);
  const std::unique_ptr<Integrator> integrator = gauss(formulation, *scene.flow, s);
  Matrix W = scene.initial;
};

TEST_P(SolverOf, LeavesWAsItWasWhenItFails) {
  const StepReport report = integrator->step(W, 50.0);
  EXPECT_EQ(report.status, Status::diverged);
  EXPECT_EQ(W, scene.initial);
  // And works again afterwards.
  EXPECT_EQ(integrator->step(W, 0.1).status, Status::converged);
}

TEST_P(SolverOf, ReportsTheSweepCap) {
  const auto capped = make_formulation(formulation, *scene.flow, gauss_tableau(s), {1e-13, 4},
                                       ProductBackend::openblas);
  const StepReport report = capped->step(W, 0.1);
  EXPECT_EQ(report.status, Status::sweep_cap);
  EXPECT_EQ(report.sweeps, 4);
  EXPECT_EQ(W, scene.initial);
}

TEST_P(SolverOf, CountsItsProductsAndPoissonSolves) {
  const StepReport report = integrator->step(W, 0.1);
  const long sweeps = report.sweeps;
  EXPECT_EQ(report.poisson_solves, s * (sweeps + 1));
  switch (formulation) {
    case Formulation::cotangent:
      EXPECT_EQ(report.products, 3 * s * (sweeps + 1) + 1);
      break;
    case Formulation::group:
      EXPECT_EQ(report.products, 3 * s * (sweeps + 1) + 2);
      break;
    case Formulation::algebra:
      EXPECT_EQ(report.products, (s * s + s) * sweeps + s);
      break;
  }
}

TEST_P(SolverOf, RefusesWrongSizesAndSteps) {
  Matrix small = Matrix::Zero(16, 16);
  EXPECT_THROW(integrator->step(small, 0.1), std::invalid_argument);
  EXPECT_THROW(integrator->step(W, nan), std::invalid_argument);
  EXPECT_THROW(integrator->step(W, infinity), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Formulations, SolverOf, ::testing::ValuesIn(methods(3)),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
