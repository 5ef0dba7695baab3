// Denormal numbers: 0 while a fast step is under way, themselves before and after.
#include "isosyrk/split/flush_denormals.h"

#include <gtest/gtest.h>

#include <limits>

#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/flows/scene.h"
#include "tests/stage_system_double.h"

namespace isosyrk::testing {
namespace {

// Half the least normal number, formed here and now.
template <class Real>
Real denormal() {
  volatile Real least = std::numeric_limits<Real>::min();
  return least * Real{0.5};
}

// Whether a denormal number counts as 0 where it is read.
template <class Real>
bool reads_denormal_as_zero() {
  volatile Real denormal = std::numeric_limits<Real>::denorm_min();
  return denormal * (Real{1} / std::numeric_limits<Real>::epsilon()) == Real{0};
}

bool flushes() {
  return denormal<float>() == 0.0f && denormal<double>() == 0.0 &&
         reads_denormal_as_zero<float>() && reads_denormal_as_zero<double>();
}
bool keeps() {
  return denormal<float>() > 0.0f && denormal<double>() > 0.0 && !reads_denormal_as_zero<float>() &&
         !reads_denormal_as_zero<double>();
}

class FlushDenormalsTest : public ::testing::Test {
 protected:
  void SetUp() override {
#if !defined(__SSE2__)
    GTEST_SKIP() << "only x86 is told";
#endif
    ASSERT_TRUE(keeps());
  }
};

TEST_F(FlushDenormalsTest, HoldsWhileOneLives) {
  {
    const FlushDenormals flush;
    EXPECT_TRUE(flushes());
    {
      const FlushDenormals again;
      EXPECT_TRUE(flushes());
    }
    EXPECT_TRUE(flushes());
  }
  EXPECT_TRUE(keeps());
}

// A method that stands still, and looks.
class Onlooker final : public StageSystemDouble {
 public:
  explicit Onlooker(Index n) : StageSystemDouble(n) {}
  bool flushed = false;
  double change = 0.0;

 protected:
  double residual_of(const SplitMatrix&, SingleMatrix& R) override {
    flushed = flushes();
    R.entries().setZero();
    return change;
  }
};

TEST_F(FlushDenormalsTest, HoldsInAFastStepAndEndsWithIt) {
  const Scene scene = smooth_scene(5);
  auto owned = std::make_unique<Onlooker>(5);
  Onlooker& form = *owned;
  FastIntegrator integrator(*scene.flow, std::move(owned), {});
  for (const double change : {0.0, 1e300}) {  // a step that works, and one that fails
    form.flushed = false;
    form.change = change;
    Matrix W = scene.initial;
    EXPECT_EQ(integrator.step(W, 0.1).status == Status::converged, change == 0.0);
    EXPECT_TRUE(form.flushed);
    EXPECT_TRUE(keeps());
  }
  form.flushed = false;
  integrator.change_of_one_more_sweep();
  EXPECT_TRUE(form.flushed);
  EXPECT_TRUE(keeps());
}

}  // namespace
}  // namespace isosyrk::testing
