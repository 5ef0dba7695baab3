// The three formulations are one method: against reference answers, against one another, for any J.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/integrators/algebra_form.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/integrators/isospectral_midpoint.h"
#include "tests/plain_isosyrk.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachFormulation : public ::testing::TestWithParam<std::tuple<Formulation, int>> {};

TEST_P(EachFormulation, EqualsTheReferenceAnswerAtN17) {
  const auto [formulation, s] = GetParam();
  const Scene scene = smooth_scene(17);
  const Matrix W = integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.1, 50);
  const Matrix reference = read_reference("W_t5_h0.1_n17_s" + std::to_string(s) + ".csv", 17);
  EXPECT_LE(largest_difference(W, reference), coincidence);
}

TEST_P(EachFormulation, IsTheSameWithEitherBackend) {
  const auto [formulation, s] = GetParam();
  const Scene scene = smooth_scene(17);
  const auto with_eigen =
      make_formulation(formulation, *scene.flow, gauss_tableau(s), {}, ProductBackend::eigen);
  EXPECT_LE(
      largest_difference(integrated(*with_eigen, scene.initial, 0.1, 10),
                         integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.1, 10)),
      coincidence);
}

TEST_P(EachFormulation, IsInvertedByAStepBackwards) {
  const auto [formulation, s] = GetParam();
  const Scene scene = smooth_scene(17);
  const auto integrator = gauss(formulation, *scene.flow, s);
  Matrix W = integrated(*integrator, scene.initial, 0.2, 5);
  EXPECT_GE(largest_difference(W, scene.initial), 0.01);
  W = integrated(*integrator, W, -0.2, 5);
  EXPECT_LE(largest_difference(W, scene.initial), coincidence);
}

TEST_P(EachFormulation, LeavesASceneAtRestAtRest) {
  const auto [formulation, s] = GetParam();
  // Zonal: W and B are diagonal and commute.
  const Scene scene = smooth_scene(17, HbarConvention::paper, {{2, 0, 1.0}, {3, 0, -0.4}});
  const long steps = 20;
  const Matrix W = integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.1, steps);
  const double moved = largest_difference(W, scene.initial);
  if (formulation == Formulation::algebra) {
    EXPECT_EQ(moved, 0.0);
  } else {
    EXPECT_LE(moved, static_cast<double>(steps) * 1e-13 / 0.7);
  }
}

TEST_P(EachFormulation, CoincidesWithTheOthersOnAnyQuadraticAlgebra) {
  const auto [formulation, s] = GetParam();
  for (const QuadraticAlgebra& algebra :
       {QuadraticAlgebra(symplectic_J(3)), QuadraticAlgebra(indefinite_J(3, 2)),
        QuadraticAlgebra(Complex(0.0, 1.0) * indefinite_J(1, 3)),
        QuadraticAlgebra::skew_hermitian(5)}) {
    const ConjugationFlow flow(algebra, 7);
    const Matrix W0 = flow.element(8);
    ASSERT_LE(algebra.algebra_defect(W0), 1e-15);
    const Matrix W = integrated(*gauss(formulation, flow, s), W0, 0.5, 10);
    const Matrix group = integrated(*gauss(Formulation::group, flow, s), W0, 0.5, 10);
    EXPECT_LE(largest_difference(W, group), 1e-12);
    EXPECT_GE(largest_difference(W, W0), 0.01);
    EXPECT_LE(algebra.algebra_defect(W), 1e-13);
    // Isospectral on every algebra: all tr(W^k).
    for (int k = 1; k <= algebra.size(); ++k) {
      EXPECT_LE(std::abs(casimir(W, k) - casimir(W0, k)), 1e-12) << k;
    }
  }
}

TEST_P(EachFormulation, WorksAtTheSmallestSizes) {
  const auto [formulation, s] = GetParam();
  for (const Index n : {2, 3, 4}) {
    std::vector<Mode> modes = {{1, 0, 0.5}, {1, 1, {0.3, -0.2}}};
    if (n > 2) modes.push_back({2, 1, {-0.7, 0.1}});
    const Scene scene = smooth_scene(n, HbarConvention::standard, modes);
    const Matrix W = integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.1, 20);
    const Matrix other =
        integrated(*gauss(Formulation::group, *scene.flow, s), scene.initial, 0.1, 20);
    EXPECT_LE(largest_difference(W, other), coincidence);
    EXPECT_LE(spectrum_error(W, scene.initial), coincidence);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachFormulation,
                         ::testing::Combine(::testing::ValuesIn(formulations()),
                                            ::testing::Values(1, 2, 3)),
                         [](const auto& tested) {
                           return std::string(name(std::get<0>(tested.param))) +
                                  std::to_string(std::get<1>(tested.param));
                         });

TEST(Formulations, CoincideForManyStages) {
  const Scene scene = smooth_scene(12, HbarConvention::standard);
  for (const int s : {4, 5, 8}) {
    const Matrix group =
        integrated(*gauss(Formulation::group, *scene.flow, s), scene.initial, 0.5, 4);
    for (const Formulation formulation : {Formulation::cotangent, Formulation::algebra}) {
      EXPECT_LE(largest_difference(
                    integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.5, 4), group),
                coincidence)
          << s;
    }
  }
}

TEST(AlgebraForm, EqualsThePlainTranscriptionOfItsEquations) {
  const Scene scene = smooth_scene(17);
  for (const int s : {1, 2, 3}) {
    AlgebraForm form(*scene.flow, gauss_tableau(s), {}, ProductBackend::openblas);
    EXPECT_LE(largest_difference(integrated(form, scene.initial, 0.1, 10),
                                 plain_isosyrk(*scene.flow, gauss_tableau(s), KIndex::corrected,
                                               scene.initial, 0.1, 10)),
              1e-12)
        << s;
  }
}

TEST(IsospectralMidpoint, EqualsTheAlgebraFormAtOneStage) {
  const Scene scene = smooth_scene(17);
  AlgebraForm form(*scene.flow, gauss_tableau(1), {}, ProductBackend::openblas);
  IsospectralMidpoint midpoint(*scene.flow, {}, ProductBackend::openblas);
  EXPECT_LE(largest_difference(integrated(form, scene.initial, 0.1, 20),
                               integrated(midpoint, scene.initial, 0.1, 20)),
            coincidence);
}

TEST(FormulationNames, AreReadBackAndOthersRefused) {
  for (const Formulation formulation : formulations()) {
    EXPECT_EQ(formulation_from_name(name(formulation)), formulation);
  }
  EXPECT_THROW(formulation_from_name("Group"), std::invalid_argument);
  EXPECT_THROW(formulation_from_name(""), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
