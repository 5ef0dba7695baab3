// States of any norm: the scale in which an integrator holds them.
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/catalogue/make_integrator.h"
#include "isosyrk/integrators/state_scale.h"
#include "isosyrk/linalg/spectrum.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

double scale_of(const Matrix& W) { return ScaleFinder(W.rows()).find(W).value; }

TEST(Scale, OfANamedSceneIsOneAndOfTheSpinChainOneHalf) {
  for (const std::string& name : scene_names()) {
    for (const Index n : {3, 4, 6, 8, 17, 32, 65, 128}) {
      if (name == "euler_top"
              ? n != 3
              : n < 5 || (n % 2 == 1 && (name == "spin_chain" || name == "symplectic")))
        continue;
      const Matrix W = scene_by_name(name, n).initial;
      const double expected = name == "spin_chain" ? 0.5 : 1.0;
      EXPECT_EQ(scale_of(W), expected) << name << " n = " << n;
      // Far from where the nearest power of two changes.
      for (const double factor : {1.0 - 1e-12, 1.0 + 1e-12, 0.85, 1.3}) {
        EXPECT_EQ(scale_of(factor * W), expected) << name << " n = " << n << " " << factor;
      }
      EXPECT_EQ(scale_of(0.5 * W), 0.5 * expected);
    }
  }
}

TEST(Scale, IsTheNearestPowerOfTwoOfTheSpectralNorm) {
  for (const Index n : {2, 7, 40, 200}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const Matrix W = random_skew_hermitian(n, seed);
      for (const double norm : {1e-200, 1e-8, 0.3, 1.0, 5.0, 1e6, 1e200}) {
        int exponent = 0;
        const double scale = scale_of(norm * W);
        EXPECT_EQ(std::frexp(scale, &exponent), 0.5) << "a power of two";
        // The estimate is from below, here by a tenth at most.
        EXPECT_LE(norm / scale, std::sqrt(2.0) / 0.9) << n << " " << seed;
        EXPECT_GE(norm / scale, std::sqrt(0.5)) << n << " " << seed;
      }
    }
  }
  // The dominant block is a small part of the matrix.
  Matrix W = 1e-3 * random_skew_hermitian(100, 1);
  W(99, 99) = Complex(0.0, 1024.0);
  EXPECT_EQ(scale_of(W), 1024.0);
  EXPECT_EQ(scale_of(Matrix::Zero(3, 3)), 1.0);
  EXPECT_EQ(scale_of(Matrix::Constant(3, 3, std::nan(""))), 1.0);
}

class EachNorm : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  static constexpr int steps = 5;
  // The relative error allowed: what the iteration of each step leaves, for contractions up to 0.8.
  static constexpr double bound = steps * 1e-13 / (1.0 - 0.8);

  // The end of a run from factor W₀ by steps of h / factor, over factor, and its sweeps.
  static std::pair<Matrix, long> end(const IntegratorEntry& entry, const Scene& scene, double h,
                                     double factor, double tolerance = 1e-13) {
    const auto integrator = made(entry, *scene.flow, {.tolerance = tolerance});
    Matrix W = factor * scene.initial;
    const RunReport report = run(*integrator, W, h / factor, steps);
    EXPECT_TRUE(report.converged()) << entry.name << " " << factor << ": " << name(report.status);
    return {W / factor, report.sweeps};
  }
};

// Products of two B's, or of two W's, neither overflow nor underflow.
TEST_P(EachNorm, MayBeNearTheEndsOfTheDoubles) {
  const Scene scene = smooth_scene(9);
  for (const IntegratorEntry& entry : forms_of(GetParam())) {
    const auto [expected, sweeps] = end(entry, scene, 0.125, 1.0);
    for (const double power : {0x1p-997, 0x1p-515, 0x1p-332, 0x1p332, 0x1p515, 0x1p997}) {
      const auto [W, count] = end(entry, scene, 0.125, power);
      EXPECT_LE((W - expected).norm(), bound) << entry.name << " " << power;
      EXPECT_EQ(count, sweeps) << entry.name << " " << power;
    }
  }
}

// A power of two moves no bit, and another factor no more than the tolerance.
TEST_P(EachNorm, GivesTheRelativeErrorsOfNormOne) {
  for (const IntegratorEntry& entry : forms_of(GetParam())) {
    for (const Index n : {9, 33, 49}) {  // with bands from 48 on
      const Scene scene = smooth_scene(n);
      const auto [expected, sweeps] = end(entry, scene, 0.1, 1.0);
      for (const double power : {0x1p-27, 0x1p-3, 0x1p20}) {
        const auto [W, count] = end(entry, scene, 0.1, power);
        EXPECT_EQ(W, expected) << entry.name << " " << power;
        EXPECT_EQ(count, sweeps) << entry.name << " " << power;
      }
      for (const double factor : {1e-8, 1e-5, 0.5, 1e3, 1e6}) {
        const Matrix W = end(entry, scene, 0.1, factor).first;
        EXPECT_LE((W - expected).norm(), bound) << entry.name << " " << factor << " n = " << n;
      }
    }
  }
}

std::vector<IntegratorEntry> scaled() {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (!entry.co_rotating || entry.name == "group2_frame") found.push_back(entry);
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(List, EachNorm, ::testing::ValuesIn(scaled()),
                         [](const auto& tested) { return tested.param.name; });

// An absolute tolerance of 1e-13 is one of 1e-5 for a state of norm 1e-8: the bound above sees it.
TEST(Norms, ATolerancePerNormIsSeen) {
  const Scene scene = smooth_scene(33);
  for (const char* name : {"cotangent2", "algebra1", "algebra2"}) {
    for (const IntegratorEntry& entry : {integrator_entry(name), fast_entry(name)}) {
      Matrix W = scene.initial, loose = scene.initial;
      run(*made(entry, *scene.flow), W, 0.1, 5);
      run(*made(entry, *scene.flow, {.tolerance = 1e-5}), loose, 0.1, 5);
      EXPECT_GT((loose - W).norm(), 1e-11) << entry.name;
    }
  }
}

// B(W) = ‖W‖² D∘W: B sees W itself, so that the speed is right.
TEST(Norms, AGeneratorThatIsNotLinearSeesWItself) {
  constexpr Index n = 5;
  for (const double norm : {1e-3, 1.0, 300.0}) {
    const Matrix W0 = norm * random_skew_hermitian(n, 3);
    double smallest = norm, largest = norm;
    const FlowOf flow(QuadraticAlgebra::skew_hermitian(n), [&](const Matrix& W, Matrix& B) {
      const double size = spectral_norm(W);
      smallest = std::min(smallest, size);
      largest = std::max(largest, size);
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) B(r, c) = W.squaredNorm() * W(r, c) / double(r + c + 2);
      }
    });
    const double time = 0.2 / std::pow(norm, 3);
    const auto end = [&](const char* name, int steps) {
      return integrated(*made(integrator_entry(name), flow), W0, time / steps, steps);
    };
    const Matrix exact = end("rk4", 400);
    for (const char* name : {"cotangent2", "group2", "algebra2", "algebra3", "yoshida4"}) {
      EXPECT_LE((end(name, 20) - exact).norm(), 1e-6 * norm) << name << " " << norm;
    }
    EXPECT_GE((exact - W0).norm(), 1e-2 * norm);
    EXPECT_GE(smallest, 0.5 * norm);
    EXPECT_LE(largest, 2.0 * norm);
  }
}

TEST(Norms, TheEnergyAndTheStateAreThoseOfW) {
  for (const Solver solver : {Solver::published, Solver::fast}) {
    for (const char* name : {"group2", "rk4", "yoshida4", "algebra1_frame"}) {
      const Scene scene = smooth_scene(9);
      const auto integrator = make_integrator(scene.flow, name, {.solver = solver});
      const Matrix W = 1e4 * scene.initial;
      integrator->set_state(W);
      EXPECT_EQ(integrator->state(), W);
      EXPECT_DOUBLE_EQ(integrator->energy(), scene.flow->energy(W));
      // A single step of another scale beside it.
      Matrix V = 1e-4 * scene.initial, expected = V;
      integrator->step(V, 100.0);
      make_integrator(scene.flow, name, {.solver = solver})->step(expected, 100.0);
      EXPECT_EQ(V, expected);
      EXPECT_EQ(integrator->state(), W);
    }
  }
}

// What a run changes between its steps: a small change keeps the predictor, a twofold one finds the
// scale again.
TEST(AmendedState, KeepsPastStepsUnlessTheNormChangesTwofold) {
  const Scene scene = smooth_scene(17);
  const auto attempt_after = [&](double factor, bool amend) {
    const auto integrator = make_integrator(scene.flow, "group2", {.solver = Solver::fast});
    integrator->set_state(scene.initial);
    for (int k = 0; k < 4; ++k) integrator->step(0.1);
    const Matrix W = factor * integrator->state();
    amend ? integrator->amend_state(W) : integrator->set_state(W);
    EXPECT_EQ(integrator->state(), W);
    const StepReport report = integrator->step(0.1);
    EXPECT_EQ(report.status, Status::converged);
    Matrix expected = W;
    make_integrator(scene.flow, "group2", {.solver = Solver::fast})->step(expected, 0.1);
    EXPECT_LE(largest_difference(integrator->state(), expected), 1e-12 * factor);
    return name(report.attempt);
  };
  EXPECT_EQ(attempt_after(0.999, true), "predicted Newton");
  EXPECT_EQ(attempt_after(0.999, false), "cold Newton");
  EXPECT_EQ(attempt_after(0.4, true), "cold Newton");
  EXPECT_EQ(attempt_after(2.5, true), "cold Newton");
}

// Where the tolerance is relative to shows in the digits of a damped run: 1e-3 of the norm is left.
TEST(AmendedState, FollowsAStateThatFadesAway) {
  const Scene scene = smooth_scene(9);
  for (const Solver solver : {Solver::published, Solver::fast}) {
    const auto integrator = make_integrator(scene.flow, "algebra2", {.solver = solver});
    integrator->set_state(scene.initial);
    Matrix W = scene.initial;
    for (int k = 0; k < 30; ++k) {
      ASSERT_EQ(integrator->step(0.1).status, Status::converged);
      W = 0.8 * integrator->state();
      integrator->amend_state(W);
    }
    EXPECT_LE(spectrum_error(W, std::pow(0.8, 30) * scene.initial), 1e-12 * std::pow(0.8, 30));
  }
}

}  // namespace
}  // namespace isosyrk::testing
