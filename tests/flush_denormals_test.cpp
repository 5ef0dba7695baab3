// Denormal numbers: 0 while a fast step is under way, themselves before and after.
#include "isosyrk/split/flush_denormals.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <limits>
#include <thread>

#include "isosyrk/fast/fast_form.h"
#include "isosyrk/flows/scene.h"
#include "isosyrk/split/team.h"

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

TEST_F(FlushDenormalsTest, HoldsInTheSecondThreadOfATeamOnly) {
  Team team(2);
  std::array<bool, 2> flushed{};
  std::atomic<int> begun{0};
  team.run(2, [&](std::size_t, std::size_t thread) {
    ++begun;
    while (begun.load() < 2) std::this_thread::yield();  // so that each thread takes one
    flushed[thread] = flushes();
  });
  EXPECT_FALSE(flushed[0]);
  EXPECT_TRUE(flushed[1]);
}

FastOptions uncorrected() {
  FastOptions options;
  options.correct = false;
  return options;
}

// A method that stands still, and looks.
class Onlooker final : public FastForm {
 public:
  explicit Onlooker(const EulerZeitlin& flow) : FastForm(flow, uncorrected(), {1}, 1) {}
  bool flushed = false;
  double change = 0.0;

 protected:
  void start_cold() override {}
  double sweep(double) override {
    flushed = flushes();
    return change;
  }
  double residual(double) override { return 0.0; }
  Index linearise(double, double) override { return 0; }
  double transport(double) override { return 0.0; }
  double couple(double) override { return 0.0; }
  void update(double, PlanarMatrix& W1) override { W1.entries() = W0_.entries(); }
};

TEST_F(FlushDenormalsTest, HoldsInAFastStepAndEndsWithIt) {
  const Scene scene = smooth_scene(5);
  Onlooker form(dynamic_cast<const EulerZeitlin&>(*scene.flow));
  for (const double change : {0.0, 1e300}) {  // a step that works, and one that fails
    form.flushed = false;
    form.change = change;
    Matrix W = scene.initial;
    EXPECT_EQ(form.Integrator::step(W, 0.1).status == Status::converged, change == 0.0);
    EXPECT_TRUE(form.flushed);
    EXPECT_TRUE(keeps());
  }
  form.flushed = false;
  form.change_of_one_more_sweep(0.1);
  EXPECT_TRUE(form.flushed);
  EXPECT_TRUE(keeps());
}

}  // namespace
}  // namespace isosyrk::testing
