#include "isosyrk/simulation/run.h"

#include <gtest/gtest.h>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(Run, AddsUpWhatItsStepsReport) {
  const Scene scene = smooth_scene(9);
  const auto integrator = gauss(Formulation::group, *scene.flow, 2);
  Matrix W = scene.initial;
  long observed = 0;
  long sweeps = 0;
  const RunReport report =
      run(*integrator, W, 0.1, 7, [&](long k, const Matrix& V, const StepReport& step) {
        EXPECT_EQ(k, ++observed);
        EXPECT_EQ(V, W);
        sweeps += step.sweeps;
      });
  EXPECT_TRUE(report.converged());
  EXPECT_EQ(report.steps, 7);
  EXPECT_EQ(report.failed_step, 0);
  EXPECT_EQ(report.sweeps, sweeps);
  EXPECT_EQ(report.products, 3 * 2 * (sweeps + 7) + 2 * 7);
  EXPECT_DOUBLE_EQ(report.sweeps_per_step(), static_cast<double>(sweeps) / 7.0);
}

TEST(Run, StopsAtTheFirstStepThatFailsAndKeepsTheLastGoodState) {
  // Fails at its third step.
  class Fragile final : public Integrator {
   public:
    explicit Fragile(const Flow& flow) : Integrator(flow, ProductBackend::openblas) {}

   protected:
    SolveReport advance(const Matrix& W0, double, Matrix& W1) override {
      W1 = 2.0 * W0;
      return {++calls_ == 3 ? Status::stagnated : Status::converged, 1, 0.25};
    }

   private:
    int calls_ = 0;
  };
  const Scene scene = smooth_scene(5);
  Fragile integrator(*scene.flow);
  Matrix W = scene.initial;
  const RunReport report = run(integrator, W, 0.1, 10);
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_EQ(report.failed_step, 3);
  EXPECT_EQ(report.steps, 2);
  EXPECT_EQ(report.last_change, 0.25);
  EXPECT_EQ(W, 4.0 * scene.initial);
}

TEST(Step, IsDivergedWhenTheUpdateOverflowsAfterItsStagesConverged) {
  class Overflowing final : public Integrator {
   public:
    explicit Overflowing(const Flow& flow) : Integrator(flow, ProductBackend::openblas) {}

   protected:
    SolveReport advance(const Matrix& W0, double, Matrix& W1) override {
      W1 = W0;
      W1(0, 0) = std::numeric_limits<double>::infinity();
      return {};
    }
  };
  const Scene scene = smooth_scene(5);
  Overflowing integrator(*scene.flow);
  Matrix W = scene.initial;
  EXPECT_EQ(integrator.step(W, 0.1).status, Status::diverged);
  EXPECT_EQ(W, scene.initial);
}

TEST(Run, OfNoStepsChangesNothing) {
  const Scene scene = smooth_scene(5);
  Matrix W = scene.initial;
  const RunReport report = run(*gauss(Formulation::algebra, *scene.flow, 1), W, 0.1, 0);
  EXPECT_TRUE(report.converged());
  EXPECT_EQ(report.sweeps_per_step(), 0.0);
  EXPECT_EQ(W, scene.initial);
}

}  // namespace
}  // namespace isosyrk::testing
