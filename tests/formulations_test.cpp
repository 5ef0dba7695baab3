// The three formulations are one method: against reference answers, against one another, for any J.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachFormulation : public ::testing::TestWithParam<Method> {};

TEST_P(EachFormulation, EqualsTheReferenceAnswerAtN17) {
  const auto [formulation, s] = GetParam();
  const Scene scene = smooth_scene(17);
  const Matrix W = integrated(*gauss(formulation, *scene.flow, s), scene.initial, 0.1, 50);
  const Matrix reference = read_reference("W_t5_h0.1_n17_s" + std::to_string(s) + ".csv", 17);
  EXPECT_LE(largest_difference(W, reference), coincidence);
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

INSTANTIATE_TEST_SUITE_P(All, EachFormulation, ::testing::ValuesIn(methods(3)),
                         ::testing::PrintToStringParamName());

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

}  // namespace
}  // namespace isosyrk::testing
