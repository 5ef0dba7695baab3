// What is reported as conserved, on changes of W whose effect is known.
#include <gtest/gtest.h>

#include <limits>

#include "isosyrk/simulation/conservation.h"
#include "isosyrk/flows/invariants.h"

namespace isosyrk {
namespace {

constexpr Index n = 9;

TEST(ConservationWatch, InitialDataHaveNoError) {
  const Scene scene = smooth_scene(n);
  ConservationWatch watch(scene);
  watch.observe(scene.initial);
  const Conservation kept = watch.report(scene.initial);
  EXPECT_EQ(kept.spectrum_error, 0.0);
  EXPECT_EQ(kept.skew_defect, 0.0);
  EXPECT_EQ(kept.energy_error, 0.0);
  EXPECT_EQ(angular_momentum_error(scene.initial, scene.initial), 0.0);
  for (const double error : casimir_errors(scene.initial, scene.initial)) EXPECT_EQ(error, 0.0);
}

// (1 + e) W: eigenvalues and angular momentum grow by 1 + e, energy by (1 + e)², tr W^k by (1 +
// e)^k.
TEST(ConservationWatch, ScalingIsSeenInEveryQuantity) {
  const Scene scene = smooth_scene(n);
  const double e = 1e-3;
  const Matrix W = (1.0 + e) * scene.initial;
  ConservationWatch watch(scene);
  watch.observe(W);
  const Conservation kept = watch.report(W);
  const double rounding = 1e-13;
  EXPECT_NEAR(kept.spectrum_error, e, rounding);  // the largest eigenvalue is 1
  EXPECT_NEAR(kept.energy_error, 2.0 * e + e * e, rounding);
  const double component = [&] {
    const auto L = angular_momentum(scene.initial);
    return std::max({std::abs(L[0]), std::abs(L[1]), std::abs(L[2])}) /
           std::hypot(L[0], L[1], L[2]);
  }();
  EXPECT_NEAR(angular_momentum_error(W, scene.initial), e * component, rounding);
  for (const int k : {2, 4}) {  // |tr W^k| = Σ|λ|^k for even k
    EXPECT_NEAR(casimir_errors(W, scene.initial)[static_cast<std::size_t>(k - 2)],
                std::pow(1.0 + e, k) - 1.0, rounding);
  }
}

TEST(ConservationWatch, EnergyErrorIsTheLargestOfTheRun) {
  const Scene scene = smooth_scene(n);
  ConservationWatch watch(scene);
  watch.observe(1.01 * scene.initial);
  watch.observe(scene.initial);
  EXPECT_NEAR(watch.report(scene.initial).energy_error, 1.01 * 1.01 - 1.0, 1e-13);
}

TEST(ConservationWatch, AnEnergyThatIsNotANumberIsNotForgotten) {
  const Scene scene = smooth_scene(n);
  ConservationWatch watch(scene);
  watch.observe(std::numeric_limits<double>::quiet_NaN() * scene.initial);
  watch.observe(scene.initial);
  EXPECT_TRUE(std::isnan(watch.report(scene.initial).energy_error));
}

TEST(ConservationWatch, SkewDefectIsSeen) {
  const Scene scene = smooth_scene(n);
  Matrix W = scene.initial;
  W(2, 3) += 1e-6;
  EXPECT_NEAR(ConservationWatch(scene).report(W).skew_defect, 1e-6, 1e-15);
}

// ad_B is diagonal in the eigenbasis of B: its eigenvalues are the differences of those of B.
TEST(GeneratorNorms, AreThoseOfBAndOfItsAdjointAction) {
  const Scene scene = smooth_scene(n);
  Matrix B(n, n);
  scene.flow->generator(scene.initial, B);
  const RealVector eigenvalues = spectrum(B);
  const GeneratorNorms norms = generator_norms(scene);
  EXPECT_DOUBLE_EQ(norms.B, spectral_norm(B));
  EXPECT_DOUBLE_EQ(norms.ad_B, eigenvalues(n - 1) - eigenvalues(0));
  EXPECT_GT(norms.ad_B, norms.B);
  EXPECT_LE(norms.ad_B, 2.0 * norms.B);
}

}  // namespace
}  // namespace isosyrk
