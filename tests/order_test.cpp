// Observed orders, and the symmetry and structure that the list of integrators claims.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/integrators/composition.h"
#include "isosyrk/linalg/adjoint_series.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachIntegrator : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  const IntegratorEntry& entry = GetParam();
  const Scene scene = smooth_scene(17);
  const std::unique_ptr<Integrator> integrator =
      entry.make(*scene.flow, {}, ProductBackend::openblas);

  static void expect_small_if_and_only_if(bool kept, double error) {
    if (kept) {
      EXPECT_LE(error, 1e-11);
    } else {
      EXPECT_GE(error, 1e-9);
    }
  }
};

TEST_P(EachIntegrator, HasItsOrder) {
  // High orders reach the plateau at once where the flow is slow: they get a faster one, and steps
  // that lie closer together.  From order 12 on they get steps at which only fast forms converge.
  const bool high = entry.order > 6;
  const bool highest = entry.order > (entry.co_rotating ? 8 : 10);
  const Scene slow_or_fast = highest ? rough_scene(17) : smooth_scene(high ? 17 : 9);
  const std::vector<long> counts =
      highest && entry.co_rotating
          ? std::vector<long>{11, 12, 13, 14, 15, 16, 17, 18, 20, 22, 24, 26, 28, 30}
      : highest ? std::vector<long>{22, 23, 24, 25, 26, 27, 28, 30, 32, 34, 36, 40, 44}
      : high    ? std::vector<long>{8, 9, 10, 11, 12, 14, 16, 20, 24}
                : std::vector<long>{2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48};
  const double time = highest ? 36.0 : high ? 6.0 : 2.0;
  const double tolerance = 1e-14;
  // The reference: order 10 or 16, at a step where its error is far below the plateau.
  const auto exact_method =
      highest ? make_fast_gauss(Formulation::group, 8, *slow_or_fast.flow, {.solver = {1e-15}})
              : gauss(Formulation::group, *slow_or_fast.flow, 5, 1e-15);
  const Matrix exact =
      integrated(*exact_method, slow_or_fast.initial, 0.05, std::lround(time / 0.05));
  std::vector<double> steps;
  std::vector<double> errors;
  const IntegratorEntry form = highest ? fast_entry(entry.name) : entry;
  const auto precise = form.make(*slow_or_fast.flow, {tolerance, 1000}, ProductBackend::openblas);
  for (const long count : counts) {
    const double h = time / static_cast<double>(count);
    const double error =
        largest_difference(integrated(*precise, slow_or_fast.initial, h, count), exact);
    // The plateau: what each step's tolerance leaves, over 1 - contraction, and a margin: 20 in
    // all.  Fast forms end far below the tolerance, and leave rounding, some 1e-14.
    if (error < (highest ? 3e-13 : 20.0 * static_cast<double>(count) * tolerance)) break;
    steps.push_back(h);
    errors.push_back(error);
  }
  ASSERT_GE(steps.size(), 4U);
  // The finest points show the order best.
  const std::size_t fitted = std::min<std::size_t>(5, steps.size());
  const std::vector<double> h(steps.end() - static_cast<long>(fitted), steps.end());
  const std::vector<double> e(errors.end() - static_cast<long>(fitted), errors.end());
  // The highest orders reach rounding before the slope has settled: 15.8 for 16.
  EXPECT_NEAR(observed_order(h, e), entry.order, highest ? 0.25 : 0.2);
}

TEST_P(EachIntegrator, KeepsTheSpectrumIfAndOnlyIfItSaysSo) {
  const Matrix W = integrated(*integrator, scene.initial, 0.5, 10);
  expect_small_if_and_only_if(entry.keeps.isospectral, spectrum_error(W, scene.initial));
}

TEST_P(EachIntegrator, IsSymmetricIfAndOnlyIfItSaysSo) {
  const Matrix there = integrated(*integrator, scene.initial, 0.5, 1);
  const Matrix back = integrated(*integrator, there, -0.5, 1);
  expect_small_if_and_only_if(entry.keeps.symmetric, largest_difference(back, scene.initial));
}

TEST_P(EachIntegrator, IteratesAndSaysSoIfAndOnlyIfItIsNotExplicit) {
  Matrix W = scene.initial;
  const StepReport report = integrator->step(W, 0.1);
  EXPECT_EQ(report.sweeps == 0, entry.keeps.is_explicit);
  EXPECT_EQ(name(report.attempt), entry.keeps.is_explicit ? "explicit" : "cold Picard");
  EXPECT_GT(report.products, 0);
  EXPECT_GT(report.poisson_solves, 0);
}

INSTANTIATE_TEST_SUITE_P(List, EachIntegrator, ::testing::ValuesIn(integrators()),
                         ::testing::PrintToStringParamName());

TEST(Composition, RefusesFractionsThatAreNotSymmetricOrDoNotSumToOne) {
  const Scene scene = smooth_scene(5);
  const auto composed = [&scene](const std::vector<double>& fractions) {
    Composition(*scene.flow, {"tried", 2, fractions}, {}, ProductBackend::openblas);
  };
  EXPECT_NO_THROW(composed({0.25, 0.5, 0.25}));
  EXPECT_THROW(composed({0.25, 0.5, 0.5}), std::invalid_argument);
  EXPECT_THROW(composed({0.2, 0.5, 0.3}), std::invalid_argument);
  EXPECT_THROW(composed({}), std::invalid_argument);
}

TEST(AdjointSeries, EqualsConjugationByTheExponential) {
  const Matrix Omega = 1.5 * random_skew_hermitian(8, 1);
  const Matrix W = random_skew_hermitian(8, 2);
  const QuadraticAlgebra algebra = QuadraticAlgebra::skew_hermitian(8);
  Products products(ProductBackend::openblas, 8);
  AdjointSeries series(algebra);
  Matrix out(8, 8);
  ASSERT_TRUE(series.conjugate(products, 0.5, Omega, W, out));
  const Matrix Q = exponential(0.5 * Omega);
  EXPECT_LE(largest_difference(out, product({Q, W, Q.adjoint()})), 1e-14);
  // Terms of a long Ω grow beyond all bounds before they fall: that is said.
  EXPECT_FALSE(series.conjugate(products, 1e6, Omega, W, out));
}

}  // namespace
}  // namespace isosyrk::testing
