#include "isosyrk/simulation/run.h"

#include <functional>
#include <type_traits>
#include <vector>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class Scripted final : public IntegratorIn<Complex> {
 public:
  using Advance = std::function<StepReport(const Matrix& W0, Matrix& W1)>;
  Scripted(const Flow& flow, Advance advance) : IntegratorIn(flow), advance_(std::move(advance)) {}

 protected:
  StepReport advance(const Matrix& W0, double, Matrix& W1) override { return advance_(W0, W1); }

 private:
  Advance advance_;
};

TEST(Run, AddsUpWhatItsStepsReport) {
  const Scene scene = smooth_scene(9);
  const auto integrator = gauss(Formulation::group, *scene.flow, 2);
  Matrix W = scene.initial;
  long observed = 0;
  long sweeps = 0;
  Matrix last;
  const RunReport report =
      run(*integrator, W, 0.1, 7, [&](long k, const Matrix& V, const StepReport& step) {
        EXPECT_EQ(k, ++observed);
        last = V;
        sweeps += step.sweeps;
      });
  EXPECT_EQ(last, W);
  EXPECT_TRUE(report.converged());
  EXPECT_EQ(report.steps, 7);
  EXPECT_EQ(report.failed_step, 0);
  EXPECT_EQ(report.sweeps, sweeps);
  EXPECT_DOUBLE_EQ(report.sweeps_per_step(), static_cast<double>(sweeps) / 7.0);
}

TEST(Run, StopsAtTheFirstStepThatFailsAndKeepsTheLastGoodState) {
  const Scene scene = smooth_scene(5);
  int calls = 0;
  Scripted integrator(*scene.flow, [&](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = 2.0 * W0;
    return {.status = ++calls == 3 ? Status::stagnated : Status::converged,
            .sweeps = 1,
            .last_change = 0.25};
  });
  Matrix W = scene.initial;
  const RunReport report = run(integrator, W, 0.1, 10);
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_EQ(report.failed_step, 3);
  EXPECT_EQ(report.steps, 2);
  EXPECT_EQ(report.last_change, 0.25);
  EXPECT_EQ(W, 4.0 * scene.initial);
}

TEST(Run, ReportsTheLargestContractionOfItsSteps) {
  const Scene scene = smooth_scene(5);
  const std::vector<double> contractions = {0.2, 0.7, 0.3, 0.9};
  std::size_t next = 0;
  Scripted integrator(*scene.flow, [&](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = W0;
    const double contraction = contractions[next++];
    return {.status = contraction < 0.8 ? Status::converged : Status::stagnated,
            .contraction = contraction};
  });
  const auto largest = [&](long steps) {
    next = 0;
    Matrix W = scene.initial;
    return run(integrator, W, 0.1, steps).contraction;
  };
  EXPECT_EQ(largest(1), 0.2);
  EXPECT_EQ(largest(3), 0.7);
  EXPECT_EQ(largest(4), 0.9) << "that of a step that failed, too";
}

TEST(Step, IsDivergedWhenTheUpdateOverflowsAfterItsStagesConverged) {
  const Scene scene = smooth_scene(5);
  Scripted integrator(*scene.flow, [](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = W0;
    W1(0, 0) = std::numeric_limits<double>::infinity();
    return {};
  });
  Matrix W = scene.initial;
  EXPECT_EQ(integrator.step(W, 0.1).status, Status::diverged);
  EXPECT_EQ(W, scene.initial);
}

// A matrix that does not lie in memory as a Matrix does is no view: a copy would be advanced
// instead.
static_assert(std::is_convertible_v<Matrix&, MatrixView>);
static_assert(std::is_convertible_v<Eigen::Map<Matrix>, MatrixView>);
static_assert(std::is_convertible_v<Eigen::Block<Matrix>, MatrixView>);
static_assert(!std::is_convertible_v<const Matrix&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::MatrixXcd&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::Map<Eigen::MatrixXcd>, MatrixView>);
static_assert(!std::is_convertible_v<RealMatrix&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::Transpose<Matrix>, MatrixView>);

TEST(Step, AdvancesWhatAViewShowsAndNothingBesideIt) {
  constexpr Index n = 9;
  const Scene scene = smooth_scene(n);
  for (const IntegratorEntry& entry : integrators()) {
    const auto make = [&] { return entry.make(*scene.flow, {}, ProductBackend::openblas); };
    Matrix W = scene.initial;
    make()->step(W, 0.1);
    EXPECT_NE(W, scene.initial);

    Matrix frame = Matrix::Constant(n + 3, n + 5, 7.0);
    frame.block(1, 2, n, n) = scene.initial;
    make()->step(frame.block(1, 2, n, n), 0.1);
    EXPECT_EQ(Matrix(frame.block(1, 2, n, n)), W) << entry.name;
    frame.block(1, 2, n, n).setConstant(7.0);
    EXPECT_EQ(frame, Matrix::Constant(n + 3, n + 5, 7.0)) << entry.name;

    // At an address that no allocator would choose.
    std::vector<Complex> numbers(n * n + 1);
    Eigen::Map<Matrix> mapped(numbers.data() + 1, n, n);
    mapped = scene.initial;
    make()->step(mapped, 0.1);
    EXPECT_EQ(Matrix(mapped), W) << entry.name;
  }
}

TEST(Step, RefusesWrongSizesAndLengths) {
  const Scene scene = smooth_scene(5);
  const auto integrator = gauss(Formulation::group, *scene.flow, 1);
  Matrix W = scene.initial, small = Matrix::Zero(4, 4);
  EXPECT_THROW(integrator->step(small, 0.1), std::invalid_argument);
  for (const double h : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(integrator->step(W, h), std::invalid_argument);
  }
}

}  // namespace
}  // namespace isosyrk::testing
