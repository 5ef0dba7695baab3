// What the list of integrators claims: order, symmetry, spectrum, Lie-Poisson structure.
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/integrators/composition.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachIntegrator : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  const IntegratorEntry& entry = GetParam();
  const Scene scene = smooth_scene(17);
  const std::unique_ptr<Integrator> integrator = made(entry, *scene.flow);

  // Of an explicit method of order 8 or 10, that its errors are seen.
  double long_step() const { return entry.co_rotating ? 2.0 : 1.0; }

  static void expect_small_if_and_only_if(bool kept, double error, double small = 1e-11,
                                          double large = 1e-9) {
    if (kept) {
      EXPECT_LE(error, small);
    } else {
      EXPECT_GE(error, large);
    }
  }
};

// Runs over `time` in which the order of a method shows, by numbers of steps.
struct OrderRuns {
  Scene scene;
  double time;
  std::vector<long> counts;
};

// Explicit methods of order 8 and 10 lose nothing that is seen at the steps of the others.
bool errs_little(const IntegratorEntry& entry) { return entry.is_explicit && entry.order >= 8; }

// From order 12 on, 10 in the frame, they take steps at which only fast forms converge.
bool is_of_highest_order(const IntegratorEntry& entry) {
  return !entry.is_explicit && entry.order > (entry.co_rotating ? 8 : 10);
}

// High orders reach the plateau at once where the flow is slow: they get a faster one, and steps
// that lie closer together.
OrderRuns order_runs(const IntegratorEntry& entry) {
  if (is_of_highest_order(entry)) {
    const std::vector<long> counts = {22, 23, 24, 25, 26, 27, 28, 30, 32, 34, 36, 40, 44};
    const std::vector<long> of_the_frame = {11, 12, 13, 14, 15, 16, 17, 18, 20, 22, 24, 26, 28, 30};
    return {rough_scene(17), 36.0, entry.co_rotating ? of_the_frame : counts};
  }
  // After its start, which is more accurate.
  if (entry.family == Family::adams_bashforth_moulton) {
    return {rough_scene(17), 6.0, {48, 56, 64, 72, 80, 88, 96}};
  }
  if (entry.order > 6) return {smooth_scene(17), 6.0, {8, 9, 10, 11, 12, 14, 16, 20, 24}};
  return {smooth_scene(9), 2.0, {2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48}};
}

TEST_P(EachIntegrator, HasItsOrder) {
  const bool highest = is_of_highest_order(entry);
  const OrderRuns runs = order_runs(entry);
  const double tolerance = 1e-14;
  // The reference: order 10 or 16, at a step where its error is far below the plateau.
  const auto exact_method =
      highest ? make_fast_gauss(Formulation::group, 8, runs.scene.flow, {.iteration = {1e-15}})
              : gauss(Formulation::group, *runs.scene.flow, 5, 1e-15);
  const Matrix exact =
      integrated(*exact_method, runs.scene.initial, 0.05, std::lround(runs.time / 0.05));
  const auto precise = made(highest && entry.has_fast_form() ? fast_entry(entry) : entry,
                            *runs.scene.flow, {.tolerance = tolerance});
  const auto error = [&](double h, long count) {
    return largest_difference(integrated(*precise, runs.scene.initial, h, count), exact);
  };
  // What each step's tolerance leaves, over 1 - contraction, and a margin: 20 in all.  Fast forms
  // end far below the tolerance, and leave rounding, some 1e-14.
  const auto plateau = [&](long count) {
    return highest ? 3e-13 : 20.0 * static_cast<double>(count) * tolerance;
  };
  // The highest orders reach rounding before the slope has settled: 15.8 for 16.
  const double order = observed_order(runs.time, runs.counts, error, plateau, 4);
  EXPECT_GE(order, entry.order - (highest ? 0.25 : 0.2));
  // Of rk10 the term of its order is so small that the next one is larger down to rounding.
  const bool is_rk10 = entry.family == Family::runge_kutta && entry.order == 10;
  const double next = is_rk10 ? 1.0 : 0.0;
  EXPECT_LE(order, entry.order + next + (highest ? 0.25 : 0.2));
}

TEST_P(EachIntegrator, KeepsTheSpectrumIfAndOnlyIfItSaysSo) {
  const double h = errs_little(entry) && !entry.keeps.isospectral ? long_step() : 0.5;
  const Matrix W = integrated(*integrator, scene.initial, h, 10);
  expect_small_if_and_only_if(entry.keeps.isospectral, spectrum_error(W, scene.initial));
}

// What a loose tolerance leaves in the solution shows in the spectrum, unless the update
// conjugates.
TEST_P(EachIntegrator, KeepsTheSpectrumAtAnyToleranceIfAndOnlyIfItSaysSo) {
  const double h = errs_little(entry) && !entry.keeps.isospectral ? long_step() : 0.5;
  const auto loose = made(entry, *scene.flow, {.tolerance = 1e-4});
  const Matrix W = integrated(*loose, scene.initial, h, 10);
  expect_small_if_and_only_if(entry.keeps.spectrum_at_any_tolerance,
                              spectrum_error(W, scene.initial), 1e-13);
}

TEST_P(EachIntegrator, IsSymmetricIfAndOnlyIfItSaysSo) {
  const double h = errs_little(entry) ? long_step() : 0.5;
  const Matrix there = integrated(*integrator, scene.initial, h, 1);
  const Matrix back = integrated(*integrator, there, -h, 1);
  expect_small_if_and_only_if(entry.keeps.symmetric, largest_difference(back, scene.initial));
}

TEST_P(EachIntegrator, IteratesAndSaysSoIfAndOnlyIfItIsNotExplicit) {
  Matrix W = scene.initial;
  const StepReport report = integrator->step(W, 0.1);
  EXPECT_EQ(report.sweeps == 0, entry.is_explicit);
  EXPECT_EQ(name(report.attempt), entry.is_explicit ? "explicit" : "cold Picard");
  EXPECT_GT(report.work.products, 0);
  EXPECT_GT(report.work.poisson_solves, 0);
}

// h is large enough for the controls to show; the generator takes the trace out before the solve
// and gives none back, so it is a gradient on u(n), as the test needs.
TEST_P(EachIntegrator, IsAPoissonMapIfAndOnlyIfItSaysSo) {
  const Scene small = smooth_scene(
      4, HbarConvention::paper,
      {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {3, 2, {-0.6, 0.9}}, {3, 0, 0.7}});
  const auto precise = made(entry, *small.flow, {.tolerance = 1e-15});
  expect_small_if_and_only_if(
      entry.keeps.lie_poisson,
      poisson_map_defect(*precise, small.initial, errs_little(entry) ? 4.0 * long_step() : 2.0),
      1e-10, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(List, EachIntegrator, ::testing::ValuesIn(integrators()),
                         ::testing::PrintToStringParamName());

TEST(Composition, RefusesFractionsThatAreNotSymmetricOrDoNotSumToOne) {
  const Scene scene = smooth_scene(5);
  const auto composed = [&scene](const std::vector<double>& fractions) {
    Composition<Complex>(scene.flow, {"tried", 2, fractions}, Formulation::algebra, {},
                         ProductBackend::openblas);
  };
  EXPECT_NO_THROW(composed({0.25, 0.5, 0.25}));
  EXPECT_THROW(composed({0.25, 0.5, 0.5}), std::invalid_argument);
  EXPECT_THROW(composed({0.2, 0.5, 0.3}), std::invalid_argument);
  EXPECT_THROW(composed({}), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
