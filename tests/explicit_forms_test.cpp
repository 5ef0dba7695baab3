// Explicit methods that leave something to the error of their steps: the stages of the fast
// Munthe-Kaas method, and the projections of projected methods; and the past of multistep methods.
#include <fmt/format.h>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/tableaux/multistep_schemes.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

Matrix reference(const Scene& scene, double time) {
  return integrated(*made(fast_entry("group8_frame"), *scene.flow, {.tolerance = 1e-15}),
                    scene.initial, time / 64.0, 64);
}

// A run, and what it takes.
struct Outcome {
  Matrix W;
  Work work;
};
Outcome run_of(const IntegratorEntry& entry, const Scene& scene, double h, long steps,
               const IterationOptions& options = {}) {
  Outcome result{scene.initial, {}};
  const RunReport report = run(*made(entry, *scene.flow, options), result.W, h, steps);
  EXPECT_TRUE(report.converged());
  result.work = report.work;
  return result;
}

std::vector<Scene> smooth_and_rough(std::initializer_list<Index> sizes) {
  std::vector<Scene> scenes;
  for (const Index n : sizes) {
    scenes.push_back(smooth_scene(n));
    scenes.push_back(rough_scene(n));
  }
  return scenes;
}

constexpr double time = 5.0;

TEST(FastMuntheKaas, MovesByLessThanAHundredthOfItsErrorAndKeepsTheSpectrum) {
  for (const Scene& scene : smooth_and_rough({17, 33, 49})) {  // with bands from 48 on
    const Matrix exact = reference(scene, time);
    for (const char* name : {"rkmk4", "rkmk4_frame"}) {
      for (const long steps : {8, 16, 32, 64}) {
        SCOPED_TRACE(fmt::format("{} {} {} {}", scene.name, scene.flow->size(), name, steps));
        const double h = time / static_cast<double>(steps);
        const Outcome published = run_of(integrator_entry(name), scene, h, steps);
        const Outcome fast = run_of(fast_entry(name), scene, h, steps);
        const double error = (published.W - exact).norm();
        EXPECT_LE((fast.W - published.W).norm(), 0.01 * error + 1e-13);
        EXPECT_LE(spectrum_error(fast.W, scene.initial), 1e-14);
        EXPECT_LT(fast.work.equivalent_products, 0.6 * published.work.equivalent_products);
        // Stages to rounding are nearer: the bound sees what is left out.
        if (steps == 8 && scene.flow->size() == 49) {
          const auto complete = made(fast_entry(name), *scene.flow, {.tolerance = 1e-15});
          Matrix W = scene.initial;
          for (long k = 0; k < steps; ++k) complete->step(W, h);
          if (name == std::string("rkmk4")) {
            EXPECT_LE((W - published.W).norm(), 1e-13);
            EXPECT_GT((fast.W - published.W).norm(), 1e-12);
          }
        }
      }
    }
  }
}

// The control: stages to a tolerance that the error of the step cannot use.
TEST(FastMuntheKaas, ALooseToleranceTouchesTheAnswerAndNotTheSpectrum) {
  const Scene scene = smooth_scene(17);
  const Matrix exact = reference(scene, time);
  const Outcome published = run_of(integrator_entry("rkmk4"), scene, 0.05, 100);
  const Outcome loose = run_of(fast_entry("rkmk4"), scene, 0.05, 100, {.tolerance = 1e-5});
  EXPECT_GT((loose.W - published.W).norm(), 0.1 * (published.W - exact).norm());
  EXPECT_LE((loose.W - published.W).norm(), 1e-4);
  EXPECT_LE(spectrum_error(loose.W, scene.initial), 1e-14);
}

TEST(FastMuntheKaas, TakesAStepAgainWhereItsErrorIsSmallerThanThatOfTheStepBefore) {
  const Scene rough = rough_scene(17);
  const double h = 0.25;
  // A state of the same norm near a zonal one, which is steady.
  Matrix slow =
      entries_of(rough.initial, [](Index r, Index c) { return r == c; }) + 0.1 * rough.initial;
  slow *= rough.initial.norm() / slow.norm();
  const auto integrator = made(fast_entry("rkmk4_frame"), *rough.flow);
  Matrix W = rough.initial;
  ASSERT_TRUE(run(*integrator, W, h, 5).converged());
  EXPECT_EQ(integrator->step(h).work.poisson_solves, 4);
  Matrix expected = slow;
  made(integrator_entry("rkmk4_frame"), *rough.flow)->step(expected, h);
  integrator->amend_state(slow);
  EXPECT_EQ(integrator->step(h).work.poisson_solves, 8);
  const Matrix exact =
      integrated(*gauss(Formulation::group, *rough.flow, 6, 1e-15), slow, h / 8.0, 8);
  EXPECT_LE((integrator->state() - expected).norm(), 0.01 * (expected - exact).norm());
  EXPECT_EQ(integrator->step(h).work.poisson_solves, 4);
}

TEST(FastMuntheKaas, UsesNoErrorOfAnotherRunOrStepSizeAndASingleStepDisturbsNone) {
  const Scene scene = smooth_scene(17);
  const auto tried = made(fast_entry("rkmk4"), *scene.flow);
  const auto expect_cold = [&](const Matrix& from, double h) {
    Matrix W = from, expected = from;
    ASSERT_EQ(continued(*made(fast_entry("rkmk4"), *scene.flow), expected, h).status,
              Status::converged);
    continued(*tried, W, h);
    EXPECT_EQ(W, expected);
  };
  Matrix W = scene.initial;
  run(*tried, W, 0.5, 5);
  expect_cold(W, 0.25);
  run(*tried, W, 0.5, 5);
  expect_cold(scene.initial, 0.5);

  const auto undisturbed = made(fast_entry("rkmk4"), *scene.flow);
  for (const auto& each : {&tried, &undisturbed}) {
    (*each)->set_state(rough_scene(17).initial);
    (*each)->step(0.5);
  }
  Matrix other = scene.initial;
  tried->step(other, 0.01);
  tried->step(0.5);
  undisturbed->step(0.5);
  EXPECT_EQ(tried->state(), undisturbed->state());
}

// Ω beyond the longest polynomial is conjugated by the series.
TEST(FastMuntheKaas, IsThePublishedFormWhereOmegaIsLarge) {
  const Scene scene = smooth_scene(17);
  const double h = 12.0 / generator_norm(scene);
  Matrix W = scene.initial, expected = scene.initial;
  ASSERT_EQ(made(fast_entry("rkmk4"), *scene.flow, {.tolerance = 1e-15})->step(W, h).status,
            Status::converged);
  ASSERT_EQ(made(integrator_entry("rkmk4"), *scene.flow)->step(expected, h).status,
            Status::converged);
  EXPECT_LE((W - expected).norm(), 1e-9);  // terms of 1e5 cancel in both
}

class EachFormOfProjection : public ::testing::TestWithParam<const char*> {
 protected:
  static IntegratorEntry form_of(const std::string& name) {
    const IntegratorEntry& published = integrator_entry(name);
    return GetParam() == std::string("fast") ? fast_entry(published) : published;
  }
  static IntegratorEntry entry() { return form_of("rk4_projected"); }
};
INSTANTIATE_TEST_SUITE_P(Forms, EachFormOfProjection, ::testing::Values("published", "fast"),
                         [](const auto& tested) { return std::string(tested.param); });

// Single steps project each time.
TEST_P(EachFormOfProjection, ErrsAsIfItProjectedAfterEachStep) {
  for (const Scene& scene : smooth_and_rough({17, 33})) {
    const Matrix exact = reference(scene, time);
    for (const long steps : {24, 48, 96}) {
      SCOPED_TRACE(fmt::format("{} {} {}", scene.name, scene.flow->size(), steps));
      const double h = time / static_cast<double>(steps);
      const auto integrator = made(entry(), *scene.flow);
      Matrix each = scene.initial, seldom = scene.initial;
      for (long k = 0; k < steps; ++k) {
        ASSERT_EQ(integrator->step(each, h).status, Status::converged);
      }
      ASSERT_TRUE(run(*integrator, seldom, h, steps).converged());
      EXPECT_LE(spectrum_error(seldom, scene.initial), 1e-14);
      EXPECT_LE(std::abs((seldom - exact).norm() / (each - exact).norm() - 1.0), 0.1);
    }
  }
}

TEST_P(EachFormOfProjection, ProjectsInARunWhereTheSpectrumDriftsAndElseNowhere) {
  const Scene scene = rough_scene(17);
  const auto projections = [&](const char* name, double h, long steps) {
    const Work with = run_of(form_of(name + std::string("_projected")), scene, h, steps).work;
    const Work without = run_of(form_of(name), scene, h, steps).work;
    EXPECT_EQ(with.products - without.products, 3 * with.projections);
    return with.projections;
  };
  for (const char* name : {"rk4", "rk5", "rk8", "rk10", "abm8"}) {
    EXPECT_EQ(projections(name, 0.02, 100), 0) << name;
  }
  const long coarse = projections("rk4", 0.3, 100);
  EXPECT_GE(coarse, 3);
  EXPECT_LE(coarse, 50);
  EXPECT_GT(projections("rk8", 0.7, 1000), 0);
  // A projection changes the state, and so begins a multistep method anew.
  const Work anew = run_of(form_of("abm8_projected"), scene, 0.14, 500).work;
  EXPECT_GT(anew.projections, 0);
  EXPECT_GE(anew.products, 2 * 500 + (3 + 10) * anew.projections + 10 * 6);
}

// The drift within a run is that of the steps since the last projection, so that the energy is as
// near to that of projections after each step as to that of the equation.
TEST_P(EachFormOfProjection, KeepsTheNormOfALongRunThatRungeKuttaLoses) {
  const Scene scene = rough_scene(17);
  const double h = 0.25;
  const Matrix lost =
      integrated(*made(integrator_entry("rk4"), *scene.flow), scene.initial, h, 800);
  EXPECT_GE(spectrum_error(lost, scene.initial), 1e-2);
  const auto integrator = made(entry(), *scene.flow);
  Matrix each = scene.initial, seldom = scene.initial;
  for (long k = 0; k < 800; ++k) integrator->step(each, h);
  ASSERT_TRUE(run(*integrator, seldom, h, 800).converged());
  EXPECT_LE(spectrum_error(seldom, scene.initial), 1e-14);
  const double energy = scene.flow->energy(scene.initial);
  const double error = std::abs(scene.flow->energy(each) / energy - 1.0);
  EXPECT_LE(std::abs(scene.flow->energy(seldom) / energy - 1.0), 2.0 * error);
}

TEST_P(EachFormOfProjection, IsNotDisturbedByAnObserverNorByRunningInParts) {
  const Scene scene = rough_scene(17);
  for (const char* name : {"rk4_projected", "rk4_projected_frame", "rk8_projected",
                           "abm8_projected", "abm8_projected_frame"}) {
    const auto integrator = made(form_of(name), *scene.flow);
    Matrix W = scene.initial, observed = scene.initial;
    ASSERT_TRUE(run(*integrator, W, 0.2, 30).converged());
    double worst = 0.0;
    const auto observe = [&](long, const Matrix& V, const StepReport&) {
      worst = larger(worst, spectrum_error(V, scene.initial));
      EXPECT_NEAR(integrator->energy(), scene.flow->energy(V), 1e-14);
    };
    ASSERT_TRUE(run(*integrator, observed, 0.2, 30, observe).converged());
    EXPECT_LE(worst, 1e-14);
    EXPECT_EQ(observed, W);
    Matrix in_parts = scene.initial;
    for (int part = 0; part < 3; ++part) run(*integrator, in_parts, 0.2, 10);
    EXPECT_EQ(in_parts, W);
  }
}

// RK4 grows there by less than to infinity, and its projection would look as good as any.
TEST_P(EachFormOfProjection, DivergesWhereRungeKuttaIsUnstableAndKeepsTheState) {
  const Scene scene = rough_scene(17);
  const auto integrator = made(entry(), *scene.flow);
  Matrix W = scene.initial;
  const RunReport report = run(*integrator, W, 5.0 / generator_norm(scene), 100);
  EXPECT_EQ(report.status, Status::diverged);
  EXPECT_LE(report.failed_step, 10);
  EXPECT_LE(spectrum_error(W, scene.initial), 1e-14);
  const Matrix before = W;
  EXPECT_EQ(integrator->step(W, 200.0).status, Status::diverged);
  EXPECT_EQ(W, before);
  EXPECT_EQ(integrator->step(200.0).status, Status::diverged);
  EXPECT_EQ(integrator->state(), before);
  EXPECT_EQ(integrator->step(0.01).status, Status::converged);  // goes on from there
}

// Of AdamsBashforthMoulton: its own steps take 2 products, those of its start 12.
class EachFormOfAMultistepMethod : public EachFormOfProjection {
 protected:
  const Scene scene = smooth_scene(17);
  const std::unique_ptr<Integrator> integrator = made(form_of("abm8"), *scene.flow);

  std::vector<long> products_of(const std::vector<double>& sizes) const {
    std::vector<long> found;
    for (const double h : sizes) found.push_back(integrator->step(h).work.products);
    return found;
  }
  // Of a start: six steps, and then two.
  const std::vector<long> start = {12, 12, 12, 12, 12, 12, 2, 2};
};
INSTANTIATE_TEST_SUITE_P(Forms, EachFormOfAMultistepMethod, ::testing::Values("published", "fast"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(EachFormOfAMultistepMethod, BeginsAnewWhereItsPastIsOfAnotherStateOrStep) {
  integrator->set_state(scene.initial);
  EXPECT_EQ(products_of(std::vector<double>(8, 0.1)), start);
  EXPECT_EQ(products_of(std::vector<double>(8, 0.05)), start) << "another h";
  const Matrix W = integrator->state();
  EXPECT_EQ(products_of({0.05}), std::vector<long>{2}) << "the state was asked for";
  integrator->amend_state((1.0 + 1e-12) * integrator->state());
  EXPECT_EQ(products_of(std::vector<double>(8, 0.05)), start) << "amended";
  EXPECT_EQ(integrator->step(1e200).status, Status::diverged);
  EXPECT_EQ(products_of(std::vector<double>(8, 0.05)), start) << "a step that failed";
  integrator->set_state(W);
  EXPECT_EQ(products_of(std::vector<double>(8, 0.05)), start) << "another state";
  Matrix beside = scene.initial;
  EXPECT_EQ(integrator->step(beside, 0.05).work.products, 12);
  EXPECT_EQ(products_of({0.05, 0.0, 0.05}), (std::vector<long>{2, 12, 12})) << "a lone step";
}

TEST_P(EachFormOfAMultistepMethod, TakesLoneStepsOfTheMethodOfItsStart) {
  Matrix W = scene.initial, expected = scene.initial;
  made(form_of("abm8"), *scene.flow)->step(W, 0.3);
  made(form_of("rk8"), *scene.flow)->step(expected, 0.3);
  EXPECT_EQ(W, expected);
}

// The coefficients, and which slope each belongs to: a run by the definition.
TEST_P(EachFormOfAMultistepMethod, IsItsDefinition) {
  const MultistepScheme& scheme = adams_bashforth_moulton8();
  const double h = 0.1;
  const auto slope = [&](const Matrix& W) { return commutator(scene.flow->dense_generator(W), W); };
  const auto rk8 = made(form_of("rk8"), *scene.flow);
  Matrix W = scene.initial;
  std::vector<Matrix> slopes;
  for (int k = 0; k < 20; ++k) {
    slopes.insert(slopes.begin(), slope(W));
    if (k < 6) {
      rk8->step(W, h);
      continue;
    }
    Matrix predicted = W, corrected = W;
    for (Index j = 0; j < 7; ++j)
      predicted += h * scheme.predictor(j) * slopes[static_cast<std::size_t>(j)];
    corrected += h * scheme.of_predicted * slope(predicted);
    for (Index j = 0; j < 7; ++j)
      corrected += h * scheme.corrector(j) * slopes[static_cast<std::size_t>(j)];
    W = corrected;
  }
  EXPECT_LE(largest_difference(integrated(*integrator, scene.initial, h, 20), W), 1e-14);
  EXPECT_GE(largest_difference(integrated(*rk8, scene.initial, h, 20), W), 1e-12);
}

TEST(FastExplicitForms, AreTheSameBitForBitWithEveryNumberOfThreads) {
  const Scene scene = smooth_scene(98);
  for (const char* name : {"rkmk4", "rk4_projected", "rk8", "abm8"}) {
    const auto result = [&](int threads) {
      const IntegratorEntry entry = fast_entry(name, {.iteration = {}, .threads = threads});
      return run_of(entry, scene, 0.1, 3).W;
    };
    const Matrix expected = result(1);
    for (const int threads : {2, 3, 8}) EXPECT_TRUE(result(threads) == expected) << threads;
  }
}

TEST(FastProjection, IsThePublishedFormInARunThatProjects) {
  const Scene scene = rough_scene(17);
  const Outcome published = run_of(integrator_entry("rk4_projected"), scene, 0.3, 20);
  const Outcome fast = run_of(fast_entry("rk4_projected"), scene, 0.3, 20);
  EXPECT_GT(published.work.products, 4 * 20);
  EXPECT_EQ(fast.work.products, published.work.products);
  EXPECT_LE((fast.W - published.W).norm(), 1e-12);
  const Outcome other = run_of(fast_entry("rk4_projected"), scene, 0.3 * (1.0 + 1e-10), 20);
  EXPECT_GT((other.W - published.W).norm(), 1e-12);
}

}  // namespace
}  // namespace isosyrk::testing
