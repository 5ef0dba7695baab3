// The solver at its limits: every step ends with the right status, in bounded time, and a step that
// does not converge leaves W as it was.
#include <cstring>
#include <limits>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

bool same_bits(const Matrix& A, const Matrix& B) {
  return std::memcmp(A.data(), B.data(), static_cast<std::size_t>(A.size()) * sizeof(Complex)) == 0;
}

class AtItsLimits : public ::testing::TestWithParam<Method> {
 protected:
  std::unique_ptr<Integrator> method(const Scene& of, const IterationOptions& options = {}) const {
    return made(gauss_entry(GetParam().formulation, GetParam().s), *of.flow, options);
  }
  bool is_algebra() const { return GetParam().formulation == Formulation::algebra; }

  // The step ends so within a few sweeps and leaves W as it was; the next one works.
  void expect_failure(const Matrix& W0, double h, Status status, int most_sweeps,
                      const IterationOptions& options = {}) const {
    const auto integrator = method(scene, options);
    Matrix W = W0;
    const StepReport report = integrator->step(W, h);
    EXPECT_EQ(report.status, status);
    EXPECT_LE(report.sweeps, most_sweeps);
    EXPECT_TRUE(same_bits(W, W0));
    W = scene.initial;
    EXPECT_EQ(integrator->step(W, 1e-6).status, Status::converged);
  }
  // The step converges within a few sweeps and moves no entry by more than this.
  void expect_rest(const Matrix& W0, double h, int most_sweeps, double moved) const {
    Matrix W = W0;
    const StepReport report = method(scene)->step(W, h);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_LE(report.sweeps, most_sweeps);
    EXPECT_LE(largest_difference(W, W0), moved);
  }
  // 20 steps of an exact equilibrium, whose sweeps contract by less than 1/2.
  void expect_equilibrium(const std::vector<Mode>& modes, int most_sweeps, bool exactly) const {
    const Scene at_rest = smooth_scene(17, HbarConvention::paper, modes);
    const auto integrator = method(at_rest);
    Matrix W = at_rest.initial;
    const auto expect_few_sweeps = [&](long, const Matrix&, const StepReport& step) {
      EXPECT_LE(step.sweeps, most_sweeps);
    };
    const RunReport report = run(*integrator, W, 0.1, 20, expect_few_sweeps);
    ASSERT_TRUE(report.converged());
    EXPECT_LT(report.contraction, 0.5);
    const double bound = exactly ? 0.0 : 20.0 * 1e-13 / (1.0 - report.contraction);
    EXPECT_LE(largest_difference(W, at_rest.initial), bound);
  }

  const Scene scene = smooth_scene(17);
};

// Sweeps at n <= 33, h = 0.1 are 19 at most for 1e-13, with a contraction of at most 0.25 a sweep:
// rounding, 1e-17, is reached within 10 more, and 50 without a better change end it.
TEST_P(AtItsLimits, ToleranceUnderRoundingEndsSoon) {
  for (const Index n : {5, 17, 33}) {
    const Scene of_n = smooth_scene(n);
    for (const double tolerance : {1e-15, 1e-17, 1e-20, 1e-300}) {
      Matrix W = of_n.initial;
      const StepReport report = method(of_n, {.tolerance = tolerance})->step(W, 0.1);
      EXPECT_TRUE(report.status == Status::stagnated || report.status == Status::converged);
      EXPECT_LE(report.sweeps, 19 + 10 + 50 + 20);
      if (report.status == Status::converged) {
        EXPECT_LT(report.last_change, tolerance);
      } else {
        EXPECT_TRUE(same_bits(W, of_n.initial));
      }
    }
  }
}

TEST_P(AtItsLimits, AFailedStepSaysSoAndLeavesWAndTheIntegratorAsTheyWere) {
  const Matrix& W0 = scene.initial;
  expect_failure(1e150 * W0, 0.1, Status::diverged, 3);
  expect_failure(W0, 50.0, Status::diverged, 50);
  expect_failure(W0, 0.1, Status::sweep_cap, 4, {.max_sweeps = 4});
  for (const double bad : {nan, infinity, -infinity}) {
    for (const Index at : {0, 8, 16}) {
      Matrix broken = W0;
      broken(at, 16 - at / 2) = bad;
      expect_failure(broken, 0.1, Status::diverged, 2);
    }
  }
}

TEST_P(AtItsLimits, NothingMovesWhereThereIsTooLittle) {
  // 1e-150 W moves by 1e-301 in a step: no unknown changes by as much as the tolerance.
  expect_rest(1e-150 * scene.initial, 0.1, 2, 1e-163);
  expect_rest(scene.initial, 1e-20, 2, 1e-16);
  expect_rest(Matrix::Zero(17, 17), 0.1, 1, 0.0);
}

TEST_P(AtItsLimits, SmallestSizesWork) {
  for (const Index n : {2, 3, 4}) {
    std::vector<Mode> modes;
    for (int l = 1; l < n; ++l) {
      modes.push_back({l, 0, 0.7});
      modes.push_back({l, 1, Complex(0.3, -0.4)});
    }
    const Scene of_n = smooth_scene(n, HbarConvention::paper, modes);
    const Matrix W = integrated(*method(of_n), of_n.initial, 0.1, 20);
    const auto group = gauss(Formulation::group, *of_n.flow, GetParam().s);
    EXPECT_LE(largest_difference(W, integrated(*group, of_n.initial, 0.1, 20)), coincidence);
    EXPECT_LE(spectrum_error(W, of_n.initial), 1e-12);
    EXPECT_LE(skew_defect(W), is_algebra() ? 0.0 : 1e-13);
  }
}

// A zonal W is diagonal, as B is: they commute, and B W̃ - (B W̃)† is 0 to the last bit; Q† W₀ Q is
// W₀ only as far as Q is unitary.  Sweeps are 10 to 14 in Table 1.
TEST_P(AtItsLimits, AZonalFlowIsAtRest) {
  expect_equilibrium({{1, 0, 0.4}, {2, 0, -0.7}, {3, 0, 0.3}, {4, 0, 0.5}}, 20, is_algebra());
}

// l = 1 alone turns as a rigid body about its own axis: B is a multiple of W, and W is at rest.
TEST_P(AtItsLimits, ARigidRotationIsAtRest) {
  const int most_sweeps = 43;  // log(1e-13) / log(1/2)
  expect_equilibrium({{1, 0, 0.4}, {1, 1, Complex(0.5, -0.2)}}, most_sweeps, false);
}

TEST_P(AtItsLimits, ProductsAndPoissonSolvesAreCounted) {
  Matrix W = scene.initial;
  const StepReport report = method(scene)->step(W, 0.1);
  const long s = GetParam().s, sweeps = report.sweeps;
  EXPECT_EQ(report.work.poisson_solves, s * (sweeps + 1));
  const long of_update = GetParam().formulation == Formulation::cotangent ? 1 : 2;
  EXPECT_EQ(report.work.products,
            is_algebra() ? (s * s + s) * sweeps + s : 3 * s * (sweeps + 1) + of_update);
}

// A NaN that appears in a stage only, after the first evaluation.
TEST_P(AtItsLimits, ANumberLostInAStageDiverges) {
  const FlowOf flow(scene.flow->algebra(), [&, calls = 0](const Matrix& W, Matrix& B) mutable {
    scene.flow->generator(W, B);
    if (++calls == 4) B(1, 2) = nan;
  });
  Matrix W = scene.initial;
  const auto integrator = gauss(GetParam().formulation, flow, GetParam().s);
  EXPECT_EQ(integrator->step(W, 0.1).status, Status::diverged);
  EXPECT_TRUE(same_bits(W, scene.initial));
}

INSTANTIATE_TEST_SUITE_P(All, AtItsLimits, ::testing::ValuesIn(methods(3)),
                         ::testing::PrintToStringParamName());

// At h‖B‖ = 1.55 corrections begin far from the solution.  Picard sweeps of algebra1 grow there.
class AtALargeStep : public ::testing::TestWithParam<Method> {
 protected:
  std::vector<std::string> attempts_of_a_run() const {
    const Scene scene = rough_scene(33);
    const IntegratorEntry entry = gauss_entry(GetParam().formulation, GetParam().s);
    Matrix W = scene.initial;
    std::vector<std::string> attempts;
    const auto note = [&](long, const Matrix&, const StepReport& step) {
      attempts.push_back(name(step.attempt));
    };
    const RunReport report = run(*made(fast_entry(entry), *scene.flow), W, 0.6, 6, note);
    EXPECT_EQ(report.converged(), attempts.size() == 6);
    return attempts;
  }
};

// An attempt that fails has made 50 sweeps without a better change, or has diverged.
TEST_P(AtALargeStep, TheFirstAttemptOfEachStepWorks) {
  const std::vector<std::string> expected = {"cold Newton",      "predicted Newton",
                                             "predicted Newton", "predicted Newton",
                                             "predicted Newton", "predicted Newton"};
  EXPECT_EQ(attempts_of_a_run(), expected);
}

INSTANTIATE_TEST_SUITE_P(All, AtALargeStep, ::testing::ValuesIn(methods(3)),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
