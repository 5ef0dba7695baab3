// What is reported as conserved, on changes of W whose effect is known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "isosyrk/flows/invariants.h"
#include "isosyrk/simulation/conservation.h"

namespace isosyrk {
namespace {

constexpr Index n = 9;

// (1 + e) W: eigenvalues and angular momentum grow by 1 + e, energy by (1 + e)², tr W^k by
// (1 + e)^k; nothing at all with e = 0.
TEST(ConservationWatch, ScalingIsSeenInEveryQuantity) {
  const Scene scene = smooth_scene(n);
  const auto L = angular_momentum(scene.initial);
  const double component =
      std::max({std::abs(L[0]), std::abs(L[1]), std::abs(L[2])}) / std::hypot(L[0], L[1], L[2]);
  for (const double e : {0.0, 1e-3}) {
    const Matrix W = (1.0 + e) * scene.initial;
    const double rounding = e == 0.0 ? 0.0 : 1e-13;
    ConservationWatch watch(scene);
    watch.observe(W);
    const Conservation kept = watch.report(W);
    EXPECT_EQ(kept.skew_defect, 0.0);
    EXPECT_NEAR(kept.spectrum_error, e, rounding);  // the largest eigenvalue is 1
    EXPECT_NEAR(kept.energy_error, 2.0 * e + e * e, rounding);
    EXPECT_NEAR(angular_momentum_error(W, scene.initial), e * component, rounding);
    const auto casimirs = casimir_errors(W, scene.initial);
    if (e == 0.0) {
      EXPECT_EQ(casimirs, (std::array<double, 4>{}));
    }
    for (const int k : {2, 4}) {  // |tr W^k| = Σ|λ|^k for even k
      EXPECT_NEAR(casimirs[static_cast<std::size_t>(k - 2)], std::pow(1.0 + e, k) - 1.0, rounding);
    }
  }
}

TEST(ConservationWatch, EnergyErrorIsTheLargestOfTheRunOrNan) {
  const Scene scene = smooth_scene(n);
  ConservationWatch watch(scene);
  const auto error_after = [&](double factor) {
    watch.observe(factor * scene.initial);
    watch.observe(scene.initial);
    return watch.report(scene.initial).energy_error;
  };
  EXPECT_NEAR(error_after(1.01), 1.01 * 1.01 - 1.0, 1e-13);
  EXPECT_TRUE(std::isnan(error_after(std::nan(""))));
}

TEST(ConservationWatch, ASkewDefectOfASingleEntryIsSeen) {
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
