// The rough scene: reproducible, the same for every n, and of the spectrum that is promised.
#include <gtest/gtest.h>

#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(RoughModes, AreTheSameForEveryN) {
  const std::vector<Mode> few = rough_modes(9);
  const std::vector<Mode> many = rough_modes(33);
  for (std::size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(few[k].l, many[k].l);
    EXPECT_EQ(few[k].m, many[k].m);
    EXPECT_EQ(few[k].value, many[k].value);
  }
}

TEST(RoughModes, FillEveryScale) {
  const Index n = 17;
  const std::vector<Mode> modes = rough_modes(n);
  EXPECT_EQ(static_cast<Index>(modes.size()), n * (n + 1) / 2 - 1);  // l = 1..n-1, m = 0..l
  EXPECT_NO_THROW(require_valid(modes, n));
}

// Energy at l: |ω_l0|² + 2 Σ |ω_lm|² over l(l+1), on average 1/l³.  Summed over 16 <= l < 256, of
// some 30000 independent normal numbers, the mean of l³ E_l is 1 to within a few per cent.
TEST(RoughModes, EnergyFallsAsTheThirdPower) {
  const int first = 16;
  const int end = 256;
  std::vector<double> energy(end, 0.0);
  for (const Mode& mode : rough_modes(end)) {
    const double weight = mode.m == 0 ? 1.0 : 2.0;
    energy[static_cast<std::size_t>(mode.l)] +=
        weight * std::norm(mode.value) / (mode.l * (mode.l + 1.0));
  }
  double mean = 0.0;
  for (int l = first; l < end; ++l) {
    mean += std::pow(l, 3) * energy[static_cast<std::size_t>(l)] / (end - first);
  }
  EXPECT_NEAR(mean, 1.0, 0.1);
}

TEST(RoughScene, IsScaledAndSkewHermitian) {
  const Scene scene = rough_scene(33);
  EXPECT_NEAR(spectral_norm(scene.initial), 1.0, 1e-12);
  EXPECT_EQ(skew_defect(scene.initial), 0.0);
  EXPECT_EQ(scene.name, "rough");
}

TEST(SceneByName, FindsEachAndNamesWhatIsAllowed) {
  for (const std::string& name : scene_names()) EXPECT_EQ(scene_by_name(name, 9).name, name);
  EXPECT_EQ(scene_by_name("smooth", 9).initial, smooth_scene(9).initial);
  EXPECT_EQ(scene_by_name("rough", 9).initial, rough_scene(9).initial);
  EXPECT_THROW(scene_by_name("calm", 9), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
