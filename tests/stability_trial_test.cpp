// No step counts as stable because nothing looked: sound methods pass, broken ones are flagged, by
// a trial, by the map's bisection and by a long run.
#include "benchmarks/stability_trial.h"

#include <gtest/gtest.h>

#include "benchmarks/long_run.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr Properties isosyrk_promise = {
    .isospectral = true, .lie_poisson = true, .symmetric = true, .is_explicit = false};

const TrialSetting& setting() {
  static const TrialSetting at_17(smooth_scene(17), ProductBackend::openblas);
  return at_17;
}

// Gauss with two stages and the sign of a_12 turned.
Tableau wrong_sign() {
  Tableau tableau = gauss_tableau(2);
  tableau.a(0, 1) = -tableau.a(0, 1);
  return tableau;
}

// The midpoint with a Hermitian part let into its update.
class SkewnessSkipped final : public Integrator {
 public:
  explicit SkewnessSkipped(const Flow& flow)
      : Integrator(flow),
        sound_(gauss(Formulation::algebra, flow, 1)),
        B_(flow.size(), flow.size()) {}

 protected:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) override {
    W1 = W0;
    const StepReport report = sound_->step(W1, h);
    // A little of the Hermitian part that the update should not have.
    flow().generator(W1, B_);
    W1 += 1e-6 * h * (product({B_, W1}) + product({B_, W1}).adjoint());
    return {.status = report.status, .sweeps = report.sweeps};
  }

 private:
  std::unique_ptr<Integrator> sound_;
  Matrix B_;
};

class BrokenTableau : public ::testing::TestWithParam<Formulation> {
 protected:
  std::unique_ptr<Integrator> broken() const {
    return make_formulation(GetParam(), *setting().scene.flow, wrong_sign(), {},
                            ProductBackend::openblas);
  }
};

TEST_P(BrokenTableau, IsFlaggedByATrialWhereTheSoundOnePasses) {
  const auto sound = gauss(GetParam(), *setting().scene.flow, 2);
  EXPECT_EQ(attempt(setting(), isosyrk_promise, *sound, 0.25, 50).status, "converged");
  EXPECT_EQ(attempt(setting(), isosyrk_promise, *broken(), 0.25, 50).status, "unstable");
}

TEST_P(BrokenTableau, HasNoCriticalStepSinceNoneWorks) {
  const Edge edge = find_edge(setting(), isosyrk_promise, *broken(), 20);
  EXPECT_FALSE(edge.critical);
  for (const Trial& trial : edge.trials) EXPECT_FALSE(trial.works()) << trial.h_norm_B;
}

TEST_P(BrokenTableau, LosesItsSpectrumInALongRun) {
  const auto sound = gauss(GetParam(), *setting().scene.flow, 2);
  const LongRun kept = long_run(setting(), *sound, 0.25, 500);
  EXPECT_EQ(kept.status, "converged");
  EXPECT_LT(kept.samples.back().spectrum_error, 1e-10);
  const LongRun lost = long_run(setting(), *broken(), 0.25, 500);
  EXPECT_TRUE(lost.status != "converged" || lost.samples.back().spectrum_error > 1e-3)
      << lost.status;
}

INSTANTIATE_TEST_SUITE_P(All, BrokenTableau, ::testing::ValuesIn(formulations()));

TEST(SkippedSkewness, IsFlaggedByATrialAndByALongRun) {
  SkewnessSkipped broken(*setting().scene.flow);
  const Trial trial = attempt(setting(), isosyrk_promise, broken, 0.25, 50);
  EXPECT_EQ(trial.status, "unstable");
  EXPECT_GT(trial.kept.skew_defect, 1e-8);
  const LongRun run = long_run(setting(), broken, 0.25, 500);
  EXPECT_GT(run.samples.back().skew_defect, 1e-6);
}

TEST(CriticalStep, IsBracketedToTwoPerCent) {
  for (const std::string name : {"group1", "algebra1", "rk4"}) {
    const IntegratorEntry& entry = integrator_entry(name);
    const auto critical = find_edge(setting(), entry).critical;
    ASSERT_TRUE(critical) << name;
    EXPECT_TRUE(critical->works.works());
    EXPECT_FALSE(critical->fails.works());
    EXPECT_LE(critical->fails.h_norm_B, 1.0201 * critical->works.h_norm_B);
    EXPECT_GT(critical->fails.h_norm_B, critical->works.h_norm_B);
  }
}

TEST(InvariantsLost, EachIsLookedAtAndNaNIsALoss) {
  const double nan = std::nan("");
  const Properties control = integrator_entry("rk4").keeps;
  EXPECT_FALSE(invariants_lost({1e-9, 1e-9, 0.5}, isosyrk_promise));
  EXPECT_TRUE(invariants_lost({1e-7, 0.0, 0.0}, isosyrk_promise));
  EXPECT_FALSE(invariants_lost({1e-7, 0.0, 0.0}, control));  // promises less
  EXPECT_TRUE(invariants_lost({0.2, 0.0, 0.0}, control));
  for (const Properties& promise : {isosyrk_promise, control}) {
    EXPECT_TRUE(invariants_lost({0.0, 1e-7, 0.0}, promise));
    EXPECT_TRUE(invariants_lost({0.0, 0.0, 1.5}, promise));
    EXPECT_TRUE(invariants_lost({nan, 0.0, 0.0}, promise));
    EXPECT_TRUE(invariants_lost({0.0, nan, 0.0}, promise));
    EXPECT_TRUE(invariants_lost({0.0, 0.0, nan}, promise));
  }
}

TEST(LongRun, SamplesEveryDecadeAndTheEnd) {
  const auto integrator =
      integrator_entry("rkmk4").make(*setting().scene.flow, {}, ProductBackend::openblas);
  const LongRun run = long_run(setting(), *integrator, 0.1, 600);
  EXPECT_EQ(run.steps, 600);
  EXPECT_EQ(run.samples.front().step, 1);
  EXPECT_EQ(run.samples.back().step, 600);
  long last = 0;
  for (const Sample& sample : run.samples) {
    EXPECT_GT(sample.step, last);
    EXPECT_NEAR(sample.time, static_cast<double>(sample.step) * run.step, 1e-12 * sample.time);
    last = sample.step;
  }
}

TEST(LongRun, ASolverThatFailsEndsIt) {
  const auto integrator = gauss(Formulation::group, *setting().scene.flow, 1);
  const LongRun run = long_run(setting(), *integrator, 8.0, 100);
  EXPECT_EQ(run.status, "diverged");
  EXPECT_EQ(run.failed_step, run.steps + 1);
}

// An explicit step far beyond its limit.
TEST(LongRun, ALossOfEverythingIsUnstableAndEndsTheSamples) {
  const auto integrator =
      integrator_entry("rk4").make(*setting().scene.flow, {}, ProductBackend::openblas);
  const LongRun run = long_run(setting(), *integrator, 2.0, 2000);
  EXPECT_TRUE(run.status == "unstable" || run.status == "diverged") << run.status;
  EXPECT_LT(run.steps, 2000);
  EXPECT_GT(run.failed_step, 0);
}

}  // namespace
}  // namespace isosyrk::testing
