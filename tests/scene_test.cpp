// Scenes: the rough one is reproducible, the same for every n and of the spectrum that is promised;
// a user's initial data are taken as they are, or refused.
#include <gtest/gtest.h>

#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(RoughModes, FillEveryScaleAndAreTheSameForEveryN) {
  const std::vector<Mode> few = rough_modes(9), many = rough_modes(33);
  EXPECT_EQ(many.size(), 33U * 34U / 2U - 1U);  // l = 1..n-1, m = 0..l
  EXPECT_NO_THROW(require_valid(many, 33));
  for (std::size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(few[k].l, many[k].l);
    EXPECT_EQ(few[k].m, many[k].m);
    EXPECT_EQ(few[k].value, many[k].value);
  }
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

TEST(SceneByName, FindsEachAndNamesWhatIsAllowed) {
  for (const std::string& name : scene_names()) EXPECT_EQ(scene_by_name(name, 9).name, name);
  EXPECT_EQ(scene_by_name("smooth", 9).initial, smooth_scene(9).initial);
  EXPECT_EQ(scene_by_name("rough", 9).initial, rough_scene(9).initial);
  expect_refused([] { scene_by_name("calm", 9); }, "rough");
}

TEST(InitialData, AreTakenAsTheyAre) {
  const Index n = 5;
  Matrix W0 = 3.0 * smooth_scene(n).initial;
  W0(0, 1) *= 1.0 + 5e-11;  // what rounding leaves of a run is less
  const Scene scene = euler_zeitlin_scene("initial", HbarConvention::standard, W0);
  EXPECT_EQ(scene.initial, W0);
  EXPECT_EQ(scene.name, "initial");
  EXPECT_EQ(scene.flow->size(), n);
}

TEST(InitialData, ThatAreNoneAreRefusedWithTheFigure) {
  const Matrix good = smooth_scene(5).initial;
  const auto refused = [](const Matrix& W0, Index n, const std::string& part) {
    expect_refused([&] { require_initial_data(W0, n); }, part);
  };
  const auto with = [&](Complex entry) {
    Matrix W0 = good;
    W0(3, 1) = entry;
    return W0;
  };
  EXPECT_NO_THROW(require_initial_data(good, 5));
  refused(good, 6, "5 x 5; must be 6 x 6");
  refused(good.leftCols(4), 5, "5 x 4; must be 5 x 5");
  refused(with({1.0, -std::numeric_limits<double>::infinity()}), 5, "entry (3, 1) is 1-infi");
  refused(with(std::numeric_limits<double>::quiet_NaN()), 5, "entry (3, 1) is nan+0i");
  refused(0.0 * good, 5, "all entries are 0");
  refused(good + 1e-3 * good.cwiseAbs().maxCoeff() * Matrix::Identity(5, 5), 5, "is 0.002 of");
  refused(good.cwiseAbs(), 5, "skew-Hermitian");
  EXPECT_THROW(
      euler_zeitlin_scene("initial", HbarConvention::paper, Matrix::Constant(1, 1, Complex(0, 1))),
      std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk::testing
