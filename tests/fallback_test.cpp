// The attempts of a fast step: each is reached where those before it fail, and none where one
// works.
#include <algorithm>
#include <limits>

#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/solver/alternating_correction.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr Index n = 5;
constexpr double h = 0.1;

// What a step is: G(x) = W₀ + g (x - W₀), of which the solver is told T and K.
struct Script {
  double g = 0.5;
  float T = 0.4f;
  float K = 0.1f;
  int cold_starts_until_finite = 0;  // residuals before are not numbers
  bool has_solution = true;          // else G(x) = x + 1
  double drift = 0.0;                // W₁ = x + drift in every entry
};

// x = G(x) for one unknown, of which x = W₀ is the solution.
class Scripted final : public StageSystem, public TwoPartJacobian {
 public:
  // Calls since the step began.
  struct Calls {
    int cold_starts = 0, residuals = 0, linearisations = 0;
    int frozen_sweeps = 0, couplings = 0, updates = 0;
  };
  Calls calls;
  Script script;
  bool flushed = false;  // at the last residual

  Unknowns unknowns() const override { return {split_stages(1, n)}; }
  void bind(const SplitMatrix& W0, double, double, StepMemory&) override {
    W0_ = &W0;
    calls = {};
  }
  void start(Unknowns& x, Start) override {
    ++calls.cold_starts;
    x[0][0].entries().setZero();
  }
  ResidualSize residual(Corrections& R, Unknowns& x, double) override {
    ++calls.residuals;
    flushed = flushes_denormals();
    Matrix change = Matrix::Ones(n, n);
    if (script.has_solution) {
      change = (1.0 - script.g) * (W0_->interleaved() - x[0][0].interleaved());
    }
    if (calls.cold_starts < script.cold_starts_until_finite) {
      change.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    R[0][0].load(change);
    return {.change = change.norm(), .neglected = 0.0};
  }
  Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) override {
    return correction_.solve(delta, *this, x, R, request, options);
  }
  void far_sweep(Corrections& delta, const Unknowns& x, const Corrections& R,
                 const IterationOptions& options) override {
    AlternatingCorrection::sweep_frozen(delta, *this, x, R, options);
  }
  void linearise(const Unknowns&, double) override { ++calls.linearisations; }
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override {
    ++calls.frozen_sweeps;
    const Eigen::VectorXf before = delta[0][0].entries();
    delta[0][0].entries() = rhs[0][0].entries() + script.T * before;
    return static_cast<double>((delta[0][0].entries() - before).norm());
  }
  void couple(Corrections& coupled, const Corrections& delta) override {
    ++calls.couplings;
    coupled[0][0].entries() = script.K * delta[0][0].entries();
  }
  void update(SplitMatrix& W1, const Unknowns& x) override {
    ++calls.updates;
    W1.load(x[0][0].interleaved() + Matrix::Constant(n, n, script.drift));
  }
  bool truncates() const override { return false; }
  void truncate(bool) override {}
  Work work() const override { return {}; }
  void archive_work(StateArchive&) override {}

 private:
  const SplitMatrix* W0_ = nullptr;
  AlternatingCorrection correction_{{split_stages(1, n)}};
};

class Fallback : public ::testing::Test {
 protected:
  explicit Fallback(const FastOptions& options = {}) {
    const auto make_system = [this] {
      auto owned = std::make_unique<Scripted>();
      system = owned.get();
      return owned;
    };
    integrator = std::make_unique<FastIntegrator>(scene.flow, make_system, options);
  }

  StepReport step(const Script& script) {
    system->script = script;
    return continued(*integrator, W, h);
  }

  // The one place that says which attempt succeeded, by what was called.
  void expect_success_of(const std::string& tried, const Script& script) {
    const Matrix before = W;
    const StepReport report = step(script);
    const auto& calls = system->calls;
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_EQ(calls.cold_starts, std::ranges::find(attempts, tried) - attempts.begin());
    EXPECT_EQ(name(report.attempt), tried);
    EXPECT_EQ(calls.updates, 1);
    EXPECT_EQ(report.sweeps, calls.residuals) << "those of failed attempts count";
    // The change is below 1e-13, and (1 - g) times the error.
    EXPECT_LE(largest_difference(W, before), 1e-13 / std::abs(1.0 - script.g));
  }

  void expect_failure(int cold_starts, const Script& script) {
    const Matrix before = W;
    const StepReport report = step(script);
    EXPECT_NE(report.status, Status::converged);
    EXPECT_EQ(system->calls.cold_starts, cold_starts);
    EXPECT_EQ(system->calls.updates, 0);
    EXPECT_EQ(report.sweeps, system->calls.residuals);
    EXPECT_EQ(W, before);
  }

  Scene scene = smooth_scene(n);
  Matrix W = 0.02 * scene.initial;  // the change of the first sweep is small enough to be corrected
  std::vector<std::string> attempts = {"predicted Newton", "cold Newton", "cold frozen Picard",
                                       "cold Anderson"};
  Scripted* system = nullptr;
  std::unique_ptr<FastIntegrator> integrator;
};

TEST_F(Fallback, TheFirstStepIsAColdNewtonAndTheNextAPredictedOne) {
  expect_success_of("cold Newton", {});
  const int sweeps = system->calls.residuals;
  EXPECT_GT(system->calls.linearisations, 0);
  EXPECT_GT(system->calls.couplings, 0);
  for (int k = 0; k < 3; ++k) {
    expect_success_of("predicted Newton", {});
    EXPECT_LT(system->calls.residuals, sweeps);
  }
}

// Residuals that are finite after so many cold starts only; the next step is predicted again.
TEST_F(Fallback, EachAttemptFollowsThoseBeforeItThatFail) {
  expect_success_of("cold Newton", {});
  for (int failures = 1; failures <= 3; ++failures) {
    expect_success_of(attempts[static_cast<std::size_t>(failures)],
                      {.cold_starts_until_finite = failures});
    const auto& calls = system->calls;
    EXPECT_EQ(calls.linearisations > 0, failures <= 2);
    EXPECT_EQ(calls.couplings > 0, failures == 1);
    EXPECT_EQ(calls.frozen_sweeps > 0, failures <= 2);
    expect_success_of("predicted Newton", {});
  }
}

// Corrections by (1 - 0.95)⁻¹ overshoot, where one frozen sweep more, 1.95 R, is nearly right.
TEST_F(Fallback, PicardWithFrozenSweepsWorksWhereCorrectionsAreTooLarge) {
  expect_success_of("cold frozen Picard", {.g = 0.5, .T = 0.95f, .K = 0.0f});
}

// Plain sweeps grow by 1.05, those with a frozen sweep and corrections by more.
TEST_F(Fallback, AndersonAccelerationWorksWhereSweepsDoNotContract) {
  expect_success_of("cold Anderson", {.g = -1.05, .T = 0.95f, .K = 0.0f});
}

TEST_F(Fallback, WhereAllFailTheStepHasFailedAndTheNextStartsCold) {
  expect_success_of("cold Newton", {});
  expect_failure(3, {.cold_starts_until_finite = 4});
  expect_success_of("cold Newton", {});
  expect_success_of("predicted Newton", {});
  expect_failure(3, {.has_solution = false});
  expect_success_of("cold Newton", {});
}

// Solutions that lie on a line are predicted to rounding by two past steps, and by one with an
// error of the drift.  A failed attempt leaves those before it to the next step.
TEST_F(Fallback, PastStepsAreKeptWhereAPredictedAttemptFails) {
  const Script drifting = {.drift = 1e-3};
  const auto sweeps_of_prediction = [&] {
    const StepReport report = step(drifting);
    EXPECT_EQ(name(report.attempt), "predicted Newton");
    return report.sweeps;
  };
  step(drifting);
  const long of_one_step = sweeps_of_prediction();
  const long of_two_steps = sweeps_of_prediction();
  EXPECT_LT(of_two_steps, of_one_step);
  const StepReport failed = step({.cold_starts_until_finite = 1, .drift = drifting.drift});
  EXPECT_EQ(name(failed.attempt), "cold Newton");
  EXPECT_EQ(sweeps_of_prediction(), of_two_steps);
}

// Whether a step works or fails.
TEST_F(Fallback, DenormalsAreFlushedWhileAStepIsUnderWay) {
#if !defined(__SSE2__)
  GTEST_SKIP() << "only x86 is told";
#endif
  const auto expect_flushed = [&](const auto& call) {
    system->flushed = false;
    call();
    EXPECT_TRUE(system->flushed);
    EXPECT_TRUE(keeps_denormals());
  };
  expect_flushed([&] { step({}); });
  expect_flushed([&] { integrator->change_of_one_more_sweep(); });
  expect_flushed([&] { step({.has_solution = false}); });
}

class FallbackWithoutNewton : public Fallback {
 protected:
  FallbackWithoutNewton() : Fallback({.iteration = {}, .newton = false}) {
    attempts = {"predicted Picard", "cold Picard", "cold Anderson"};
  }
};

TEST_F(FallbackWithoutNewton, IsPredictedPicardThenColdPicardThenAnderson) {
  const auto expect_success = [&](const std::string& tried, const Script& script) {
    expect_success_of(tried, script);
    EXPECT_EQ(system->calls.linearisations, 0);
    EXPECT_EQ(system->calls.frozen_sweeps, 0);
    EXPECT_EQ(system->calls.couplings, 0);
  };
  expect_success("cold Picard", {});
  expect_success("predicted Picard", {});
  expect_success("cold Picard", {.cold_starts_until_finite = 1});
  expect_success("cold Anderson", {.cold_starts_until_finite = 2});
  expect_success("predicted Picard", {});
  expect_failure(2, {.cold_starts_until_finite = 3});
  W *= 0.5;
  expect_success("cold Anderson", {.g = -1.05});
}

}  // namespace
}  // namespace isosyrk::testing
