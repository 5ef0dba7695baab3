// Observed orders, and the symmetry and structure that the list of integrators claims.
#include <gtest/gtest.h>

#include "core/gauss_tableau.h"
#include "core/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachIntegrator : public ::testing::TestWithParam<IntegratorEntry> {};

TEST_P(EachIntegrator, HasItsOrder) {
  const IntegratorEntry& entry = GetParam();
  const Scene scene = smooth_scene(9);
  const double time = 2.0;
  // The reference: five stages, order 10, at a step where its error is far below the plateau.
  const Matrix exact =
      integrated(*gauss(Formulation::group, *scene.flow, 5, 1e-15), scene.initial, 0.05, 40);
  std::vector<double> steps;
  std::vector<double> errors;
  const auto integrator = entry.make(*scene.flow, {1e-14, 1000}, ProductBackend::openblas);
  for (const long count : {2L, 3L, 4L, 6L, 8L, 12L, 16L, 24L, 32L, 48L}) {
    const double h = time / static_cast<double>(count);
    const double error =
        largest_difference(integrated(*integrator, scene.initial, h, count), exact);
    // The rounding plateau: 48 steps of tolerance 1e-14, and a margin of 20.
    if (error < 1e-11) break;
    steps.push_back(h);
    errors.push_back(error);
  }
  ASSERT_GE(steps.size(), 4U);
  // The finest points show the order best.
  const std::size_t fitted = std::min<std::size_t>(5, steps.size());
  const std::vector<double> h(steps.end() - static_cast<long>(fitted), steps.end());
  const std::vector<double> e(errors.end() - static_cast<long>(fitted), errors.end());
  EXPECT_NEAR(observed_order(h, e), entry.order, 0.2);
}

TEST_P(EachIntegrator, KeepsTheSpectrumIfAndOnlyIfItSaysSo) {
  const IntegratorEntry& entry = GetParam();
  const Scene scene = smooth_scene(17);
  const auto integrator = entry.make(*scene.flow, {}, ProductBackend::openblas);
  const double error =
      spectrum_error(integrated(*integrator, scene.initial, 0.5, 10), scene.initial);
  if (entry.isospectral) {
    EXPECT_LE(error, 1e-11);
  } else {
    EXPECT_GE(error, 1e-9);
  }
}

TEST_P(EachIntegrator, IsSymmetricIfItSaysSo) {
  const IntegratorEntry& entry = GetParam();
  const Scene scene = smooth_scene(17);
  const auto integrator = entry.make(*scene.flow, {}, ProductBackend::openblas);
  const Matrix there = integrated(*integrator, scene.initial, 0.5, 1);
  const double error = largest_difference(integrated(*integrator, there, -0.5, 1), scene.initial);
  if (entry.symmetric) {
    EXPECT_LE(error, 1e-11);
  } else {
    EXPECT_GE(error, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(List, EachIntegrator, ::testing::ValuesIn(integrators()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace isosyrk::testing
