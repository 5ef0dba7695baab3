// The fast forms: the answers of the published ones, accepted as strictly, in fewer sweeps.
#include "isosyrk/catalogue/fast_forms.h"

#include <tuple>

#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/solver/tuning.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

std::unique_ptr<FastIntegrator> fast(const Method& method, const Flow& flow,
                                     const FastOptions& options = {}) {
  auto made = make_fast_gauss(method.formulation, method.s, lent(flow), options);
  return std::unique_ptr<FastIntegrator>(&dynamic_cast<FastIntegrator&>(*made.release()));
}

class EachFastForm : public ::testing::TestWithParam<Method> {
 protected:
  static std::unique_ptr<FastIntegrator> form(const Scene& scene, const FastOptions& options = {}) {
    return fast(GetParam(), *scene.flow, options);
  }

  // The end and the report of so many steps, accepted as strictly as those of the published form.
  static std::pair<Matrix, RunReport> strict_run(const Scene& scene, long steps,
                                                 const FastOptions& options = {}) {
    const auto integrator = form(scene, options);
    const auto expect_accepted_strictly = [&](long step, const Matrix&, const StepReport&) {
      EXPECT_LT(integrator->change_of_one_more_sweep(), 1.5e-13) << step;
    };
    Matrix W = scene.initial;
    const RunReport report = run(*integrator, W, 0.1, steps, expect_accepted_strictly);
    EXPECT_TRUE(report.converged());
    EXPECT_EQ(skew_defect(W), 0.0);
    const bool algebra = GetParam().formulation == Formulation::algebra;
    EXPECT_LE(spectrum_error(W, scene.initial), algebra ? 1e-13 : 1e-11);
    return {W, report};
  }
};

TEST_P(EachFastForm, GivesTheAnswerOfThePublishedFormAsStrictlyInFewerSweeps) {
  for (const Index n : {5, 16, 17, 33, 49}) {  // with bands from 48 on
    SCOPED_TRACE(n);
    const Scene scene = smooth_scene(n);
    Matrix expected = scene.initial;
    const auto published = gauss(GetParam().formulation, *scene.flow, GetParam().s);
    const RunReport plain = run(*published, expected, 0.1, 50);
    const auto [W, report] = strict_run(scene, 50);
    EXPECT_LE(largest_difference(W, expected), coincidence);
    EXPECT_LT(report.sweeps, 0.8 * static_cast<double>(plain.sweeps));
    EXPECT_LT(report.work.equivalent_products, 0.7 * plain.work.equivalent_products);
  }
}

// Sweeps of the first hundred of 2000 steps after the first twenty, and of the last hundred.
std::pair<long, long> sweeps_first_and_last(Integrator& integrator, const Scene& scene) {
  Matrix W = scene.initial;
  const auto sweeps = [&](long steps) {
    const RunReport report = run(integrator, W, 0.1, steps);
    EXPECT_TRUE(report.converged());
    return report.sweeps;
  };
  sweeps(20);
  const long first = sweeps(100);
  sweeps(1780);
  const long last = sweeps(100);
  EXPECT_EQ(skew_defect(W), 0.0);
  return {first, last};
}

// The smooth scene grows finer, and the rough one is as fine at the end as at the beginning.
TEST_P(EachFastForm, TakesAsManySweepsAfterALargeNumberOfSteps) {
  const auto expect_as_many_in = [](const Scene& scene) {
    const auto integrator = form(scene);
    const auto [first, last] = sweeps_first_and_last(*integrator, scene);
    // Below n = 24 three Picard sweeps after the first are cheaper than a correction, and more of
    // them may be needed later; no more are taken.  Rounding adds one in some steps, a tenth here.
    const bool sweeps_first = scene.flow->size() < 24;
    EXPECT_LE(static_cast<double>(last), sweeps_first ? 410.0 : 1.1 * static_cast<double>(first));
  };
  for (const Index n : {17, 33}) {
    SCOPED_TRACE(n);
    expect_as_many_in(smooth_scene(n));
    expect_as_many_in(rough_scene(n));
  }
  if (GetParam().s == 2) expect_as_many_in(smooth_scene(65));
}

TEST_P(EachFastForm, StartsColdAfterAnotherStepSizeAndAnotherState) {
  for (const Index n : {17, 49}) {  // without and with bands
    SCOPED_TRACE(n);
    const Scene scene = smooth_scene(n);
    const auto tried = form(scene);
    const auto expect_cold = [&](const Matrix& from, double h, const char* after) {
      Matrix W = from, expected = from;
      const StepReport cold = form(scene)->step(expected, h);
      const StepReport report = continued(*tried, W, h);
      EXPECT_EQ(report.status, Status::converged) << after;
      EXPECT_EQ(W, expected) << after;  // bit for bit: nothing of what was before is left
      EXPECT_EQ(report.sweeps, cold.sweeps) << after;
    };
    Matrix W = scene.initial;
    run(*tried, W, 0.1, 30);
    expect_cold(W, 0.05, "another step size");
    expect_cold(scene.initial, 0.05, "another state");
  }
}

TEST_P(EachFastForm, PredictionsSaveSweeps) {
  const Scene scene = smooth_scene(17);
  long last = std::numeric_limits<long>::max();
  for (const int past_steps : {0, 2, 4, 16}) {
    const auto integrator =
        form(scene, {.iteration = {}, .past_steps = past_steps, .newton = false});
    Matrix W = scene.initial;
    const long sweeps = run(*integrator, W, 0.1, 50).sweeps;
    EXPECT_LT(sweeps, last) << past_steps;
    last = sweeps;
  }
}

double per_sweep(const RunReport& report) {
  return report.work.equivalent_products / static_cast<double>(report.sweeps);
}

// Bands also where they do not pay.
TEST_P(EachFastForm, CorrectionsAndBandsChangeTheCostAndNotTheAnswer) {
  for (const Index n : {5, 16, 33}) {
    SCOPED_TRACE(n);
    const Scene scene = smooth_scene(n);
    Matrix expected;
    const auto integrate = [&](bool newton, bool bands) {
      const FastOptions options = {.iteration = {}, .newton = newton, .bands = bands};
      EXPECT_EQ(form(scene, options)->truncates(), bands);
      const auto [W, report] = strict_run(scene, 20, options);
      if (expected.size() == 0) expected = W;
      EXPECT_LE(largest_difference(W, expected), 1e-12);
      return report;
    };
    const RunReport plain = integrate(false, false);
    const RunReport corrected = integrate(true, false);
    EXPECT_LT(corrected.sweeps, 0.9 * static_cast<double>(plain.sweeps));
    const RunReport banded = integrate(false, true);
    const double least_saving = n == 33 ? 0.95 : 1.0;
    EXPECT_LE(per_sweep(banded), least_saving * per_sweep(plain));
    const auto sweeps = static_cast<double>(plain.sweeps);
    EXPECT_NEAR(static_cast<double>(banded.sweeps), sweeps, 0.05 * sweeps);
    // A cut is rounding to the iteration, and may move a step at the edge of its tolerance by a
    // sweep, up or down: at n = 16, where bands save 1 %, that may outweigh them.
    if (n != 16) {
      EXPECT_LE(banded.work.equivalent_products, least_saving * plain.work.equivalent_products);
    }
    const double both = integrate(true, true).work.equivalent_products;
    if (n > 5) {  // which the modes, up to degree 4, fill
      EXPECT_LT(both, corrected.work.equivalent_products);
    }
  }
}

// The solver's noise, which moves the spectrum of cotangent and group, adds up to no more than that
// of the published forms.
TEST_P(EachFastForm, CorrectionsAndBandsLeaveTheSpectrumAsPublishedFormsDoOverALargeNumberOfSteps) {
  if (GetParam().s > 2) return;
  const Scene scene = smooth_scene(33);
  const auto drift = [&](Integrator& integrator) {
    return spectrum_error(integrated(integrator, scene.initial, 0.1, 500), scene.initial);
  };
  const auto integrator = form(scene, {.iteration = {}, .newton = true, .bands = true});
  const auto published = gauss(GetParam().formulation, *scene.flow, GetParam().s);
  EXPECT_LE(drift(*integrator), 3.0 * drift(*published) + 1e-13);
}

// Bands are as wide as the tolerance asks for: what a loose one leaves out, a full sweep sees, at
// every step by more than what GivesTheAnswerOfThePublishedForm... allows.
TEST_P(EachFastForm, BandsFollowTheTolerance) {
  const Scene scene = smooth_scene(49);
  constexpr double loose = 1e-6;
  const auto integrator =
      form(scene, {.iteration = {.tolerance = loose}, .newton = false, .bands = true});
  Matrix W = scene.initial;
  for (int step = 0; step < 10; ++step) {
    ASSERT_EQ(continued(*integrator, W, 0.1).status, Status::converged);
    const double change = integrator->change_of_one_more_sweep();
    EXPECT_LT(change, 1.5 * loose);
    EXPECT_GT(change, 1e-10);
  }
}

TEST_P(EachFastForm, UsesAsManyThreadsAsAreAskedForAndHelp) {
  struct Case {
    Index n;
    int asked;
    int used;
  };
  for (const auto& [n, asked, used] : std::vector<Case>{
           {33, 8, 1}, {95, 8, 1}, {96, 8, 2}, {96, 1, 1}, {129, 8, 3}, {129, 2, 2}}) {
    const Scene scene = smooth_scene(n);
    const auto integrator = form(scene, {.iteration = {}, .threads = asked});
    EXPECT_EQ(integrator->threads(), used) << n;
  }
}

// Where a run ends, what it takes, and how strictly it was accepted, with threads at any size.
void expect_the_same_bit_for_bit(const Method& method, Index n, int steps,
                                 const std::vector<int>& numbers_of_threads) {
  const Scene scene = smooth_scene(n);
  const auto result = [&](int threads) {
    const auto system = [&] {
      return gauss_system(method.formulation, method.s, *scene.flow, threads,
                          n >= tuning.smallest_banded);
    };
    FastIntegrator integrator(scene.flow, system, {.iteration = {}, .threads = threads});
    EXPECT_EQ(integrator.threads(), threads);
    Matrix W = scene.initial;
    const RunReport report = run(integrator, W, 0.1, steps);
    EXPECT_TRUE(report.converged());
    return std::tuple(W, report.sweeps, report.work.products, report.work.equivalent_products,
                      report.work.poisson_solves, integrator.change_of_one_more_sweep());
  };
  const auto expected = result(1);
  for (const int threads : numbers_of_threads) {
    EXPECT_TRUE(result(threads) == expected) << n << " " << threads;  // without printing them
  }
}

// With 10 steps the last starts from fitted weights.
TEST_P(EachFastForm, IsTheSameBitForBitWithEveryNumberOfThreads) {
  const bool is_large = GetParam().s > 3;
  for (const Index n : {5, 17}) {
    expect_the_same_bit_for_bit(GetParam(), n, 3, {2, 3, 4, 8});
  }
  expect_the_same_bit_for_bit(GetParam(), 49, is_large ? 3 : 10, {2, 3, 4, 8});
}

// Copies of B from 73, of single ones from 105.
TEST_P(EachFastForm, IsTheSameBitForBitWithEveryNumberOfThreadsAtLargeSizes) {
  const bool is_large = GetParam().s > 3;
  for (const Index n : {66, 98, 129}) {
    expect_the_same_bit_for_bit(GetParam(), n, 2,
                                is_large ? std::vector{2, 3} : std::vector{2, 3, 4, 8});
  }
  for (const Index n : {75, 107}) expect_the_same_bit_for_bit(GetParam(), n, 2, {2});
}

INSTANTIATE_TEST_SUITE_P(All, EachFastForm, ::testing::ValuesIn(methods(4)),
                         ::testing::PrintToStringParamName());

class EachListedFastForm : public ::testing::TestWithParam<IntegratorEntry> {};

// An accepted step is within tolerance / (1 - contraction) of the solution in both forms, and 10
// steps add up; explicit forms differ by the rounding of some hundred products.  Their steps are of
// two sizes by turns, so that none is left to the error of the one before, as those of the fast
// Munthe-Kaas method else are (tests/explicit_forms_test.cpp).
TEST_P(EachListedFastForm, GivesTheAnswerOfThePublishedForm) {
  const IntegratorEntry& published = GetParam();
  const IntegratorEntry fast = fast_entry(published);
  const double bound = published.is_explicit ? 1e-14 : 20.0 * IterationOptions{}.tolerance;
  for (const char* scene_name : {"smooth", "rough"}) {
    for (const Index n : {5, 17, 49}) {  // with bands from 48 on
      const Scene scene = scene_by_name(scene_name, n);
      const double h = 0.2 / generator_norms(scene).B;
      const auto after_ten_steps = [&](const IntegratorEntry& entry, double step) {
        if (!entry.is_explicit) {
          return integrated(*made(entry, *scene.flow), scene.initial, step, 10);
        }
        const auto integrator = made(entry, *scene.flow, {.tolerance = 1e-15});
        integrator->set_state(scene.initial);
        for (int k = 0; k < 10; ++k) integrator->step(k % 2 == 0 ? step : 0.9 * step);
        return integrator->state();
      };
      const Matrix expected = after_ten_steps(published, h);
      EXPECT_LE((after_ten_steps(fast, h) - expected).norm(), bound) << scene_name << " n = " << n;
      // Sees a step that is off by 1e-10.
      EXPECT_GT((after_ten_steps(fast, h * (1.0 + 1e-10)) - expected).norm(), bound);
    }
  }
}

// What a failed step leaves in the workspace, NaN too, does not enter the next one.
TEST_P(EachListedFastForm, WorksAsANewOneAfterAFailureAndSoDoesThePublishedForm) {
  const Scene scene = smooth_scene(17);
  const Matrix not_finite = Matrix::Constant(17, 17, std::nan(""));
  for (const IntegratorEntry& entry : {fast_entry(GetParam()), GetParam()}) {
    Matrix expected = scene.initial;
    EXPECT_EQ(made(entry, *scene.flow)->step(expected, 0.1).status, Status::converged);
    for (const auto& [state, h] : {std::pair{scene.initial, 1e200}, std::pair{not_finite, 0.1}}) {
      const auto integrator = made(entry, *scene.flow);
      Matrix W = state;
      EXPECT_NE(continued(*integrator, W, h).status, Status::converged);
      W = scene.initial;
      EXPECT_EQ(continued(*integrator, W, 0.1).status, Status::converged);
      EXPECT_EQ(W, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachListedFastForm, ::testing::ValuesIn(fast_integrators()),
                         [](const auto& tested) { return tested.param.name; });

TEST(FastForms, EveryRecordedIntegratorHasOne) {
  for (const std::string& name : recorded_integrators()) {
    EXPECT_TRUE(integrator_entry(name).has_fast_form()) << name;
  }
}

TEST(FastForms, AreRefusedWhereThereIsOnlyAPublishedForm) {
  for (const char* control : {"algebra2_two_products", "yoshida4_group"}) {
    EXPECT_FALSE(integrator_entry(control).has_fast_form());
    expect_refused([&] { fast_entry(control); }, "has no fast form");
  }
}

// With up to 7 past steps the prediction is the polynomial through them, which predicts a solution
// worse that grows finer, and plain sweeps make up for it one by one: what the bound of a tenth
// sees.
TEST(FastForms, FittedWeightsSaveSweepsAfterALargeNumberOfSteps) {
  const Scene scene = smooth_scene(33);
  const auto sweeps = [&](int past_steps) {
    const auto integrator = fast({Formulation::cotangent, 2}, *scene.flow,
                                 {.iteration = {}, .past_steps = past_steps, .newton = false});
    return sweeps_first_and_last(*integrator, scene);
  };
  const auto [first, last] = sweeps(7);
  EXPECT_GT(static_cast<double>(last), 1.2 * static_cast<double>(first));
  EXPECT_LT(static_cast<double>(sweeps(16).second), 0.8 * static_cast<double>(last));
}

// Another state, so that comparisons bit for bit are ones that can fail.
TEST(FastForms, ADifferenceOfTheLastDigitIsSeen) {
  const Scene scene = smooth_scene(17);
  Matrix W = scene.initial, V = scene.initial;
  V(0, 0) += Complex(0.0, 1e-15);
  run(*fast({Formulation::group, 2}, *scene.flow), W, 0.1, 3);
  run(*fast({Formulation::group, 2}, *scene.flow), V, 0.1, 3);
  EXPECT_FALSE(V == W);
}

TEST(FastForms, RefuseWhatTheyCannotDo) {
  const Scene scene = smooth_scene(5);
  for (const int threads : {-1, 0, 65}) {
    EXPECT_THROW(fast({Formulation::group, 2}, *scene.flow, {.iteration = {}, .threads = threads}),
                 std::invalid_argument);
  }
  EXPECT_THROW(fast({Formulation::group, 0}, *scene.flow), std::invalid_argument);
  EXPECT_THROW(fast_gauss_entry(Formulation::group, 0), std::invalid_argument);
  const ConjugationFlow of_another_algebra(QuadraticAlgebra(indefinite_J(3, 2)), 1);
  for (const Method& method : methods(2)) {
    EXPECT_THROW(fast(method, of_another_algebra), std::invalid_argument);
  }
}

// h‖B‖ = 1.86: of the published forms algebra with s = 2, 3 works there, cotangent and group fail.
class LargeStep : public ::testing::TestWithParam<int> {};

TEST_P(LargeStep, WorksInEveryFastFormWherePublishedFormsFail) {
  const int s = GetParam();
  const Scene scene = smooth_scene(129);
  // One of the roots that a step of this size has is the method's: that which algebra finds.
  Matrix expected = scene.initial;
  const auto published = gauss(Formulation::algebra, *scene.flow, std::max(s, 2));
  ASSERT_TRUE(run(*published, expected, 0.2, 3).converged());
  for (const Formulation formulation : formulations()) {
    const auto integrator = fast({formulation, s}, *scene.flow);
    Matrix W = scene.initial;
    ASSERT_TRUE(run(*integrator, W, 0.2, 3).converged()) << name(formulation);
    EXPECT_LE(spectrum_error(W, scene.initial), 1e-11) << name(formulation);
    EXPECT_LE(largest_difference(W, expected), s == 1 ? 0.1 : 1e-11) << name(formulation);
  }
}

INSTANTIATE_TEST_SUITE_P(Stages, LargeStep, ::testing::Values(1, 2, 3));

// Steps so long that many predictions fail (h‖B‖ = 1.5 to 2.4).  The control forgets: it goes on by
// a new integrator after each prediction that failed.
TEST(LongSteps, TakeFewerSweepsSincePastStepsOutlastPredictionsThatFail) {
  const Scene scene = rough_scene(17);
  const auto sweeps = [&](const Method& method, double h, bool forgets) {
    long total = 0;
    Matrix W = scene.initial;
    auto integrator = fast(method, *scene.flow);
    bool is_new = true;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = continued(*integrator, W, h);
      EXPECT_EQ(report.status, Status::converged) << k;
      total += report.sweeps;
      const bool failed = report.attempt.start == Start::cold && !is_new;
      is_new = forgets && failed;
      if (is_new) integrator = fast(method, *scene.flow);
    }
    return total;
  };
  long keeping = 0;
  long forgetting = 0;
  for (const auto& [method, h] : {std::pair{Method{Formulation::group, 1}, 1.6},
                                  {Method{Formulation::group, 2}, 1.45},
                                  {Method{Formulation::algebra, 1}, 1.0}}) {
    keeping += sweeps(method, h, false);
    forgetting += sweeps(method, h, true);
  }
  EXPECT_LT(static_cast<double>(keeping), 0.8 * static_cast<double>(forgetting));
}

}  // namespace
}  // namespace isosyrk::testing
