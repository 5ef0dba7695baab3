// The co-rotating frame: exact, and worth its name.
#include "isosyrk/flows/co_rotating_frame.h"

#include "isosyrk/catalogue/make_integrator.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/split/skew.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr Index n = 9;

std::unique_ptr<Integrator> named(const std::string& name, const Scene& scene) {
  return made(integrator_entry(name), *scene.flow);
}

// The part of W with l = 1, from its angular momentum L: i Σ_a L_a S_a / tr S_a².
Matrix rotation_part(const Matrix& W) {
  const auto S = spin_matrices(W.rows());
  const auto L = angular_momentum(W);
  Matrix part = Matrix::Zero(W.rows(), W.rows());
  for (std::size_t a = 0; a < 3; ++a) {
    part += Complex(0.0, L[a] / (S[a] * S[a]).trace().real()) * S[a];
  }
  return part;
}

TEST(CoRotatingFrame, ItsGeneratorAndItsHamiltonianAreThoseOfWWithoutItsRotation) {
  const auto shared = std::make_shared<const EulerZeitlin>(n);
  const EulerZeitlin& flow = *shared;
  CoRotatingFrame frame(shared);
  const Matrix W = random_skew_hermitian(n, 1), rotation = rotation_part(W);
  Matrix B(n, n), expected(n, n);
  frame.flow()->generator(W, B);
  flow.generator(W - rotation, expected);
  EXPECT_LE(largest_difference(B, expected), 1e-14);
  flow.generator(W, expected);
  EXPECT_GE(largest_difference(B, expected), 1e-3);

  SplitStages split = {SplitMatrix(W)}, upper = split_stages(1, n);
  frame.flow()->split_generator()->upper_within(n - 1, split, upper);
  mirror_skew(upper);
  EXPECT_LE(largest_difference(upper[0].interleaved(), B), 1e-14);

  EXPECT_NEAR(frame.flow()->hamiltonian(W), flow.hamiltonian(W) - flow.hamiltonian(rotation),
              1e-14);
}

// e^{tR} with R written out, in rotations by all angles, about axes too and without a rotation.
TEST(CoRotatingFrame, LeavesByTheExponentialOfTheRotation) {
  const auto shared = std::make_shared<const EulerZeitlin>(n, HbarConvention::standard);
  const EulerZeitlin& flow = *shared;
  CoRotatingFrame frame(shared);
  std::vector<Matrix> states = {Matrix::Zero(n, n)};
  for (const unsigned seed : {3u, 4u, 5u}) states.push_back(random_skew_hermitian(n, seed));
  for (const Matrix& S : spin_matrices(n)) {
    for (const double rate : {0.1, -0.1}) states.push_back(Complex(0.0, rate) * S);
  }
  const Matrix V = random_skew_hermitian(n, 20);
  for (const Matrix& W0 : states) {
    Matrix R(n, n), W(n, n);
    flow.generator(rotation_part(W0), R);
    const CoRotatingFrame::Rate rate = frame.rate(W0);
    for (const double t : {0.0, 0.3, 2.0, -7.0, 40.0}) {
      frame.leave(rate, t, V, W);
      EXPECT_LE(largest_difference(W, product({exponential(t * R), V, exponential(-t * R)})), 1e-12)
          << t;
      EXPECT_EQ(W, Matrix(-W.adjoint()));
    }
  }
}

TEST(CoRotatingFrame, TurnsAlikeByAnyNumberOfThreads) {
  constexpr Index size = 129;  // several blocks
  const auto shared = std::make_shared<const EulerZeitlin>(size);
  const Matrix V = random_skew_hermitian(size, 1);
  Matrix W(size, size), other(size, size);
  CoRotatingFrame alone(shared);
  const CoRotatingFrame::Rate rate = alone.rate(V);
  alone.leave(rate, 0.7, V, W);
  for (const int threads : {2, 3}) {
    CoRotatingFrame(shared, threads).leave(rate, 0.7, V, other);
    EXPECT_EQ(other, W) << threads;
  }
  alone.leave(rate, 0.70001, V, other);
  EXPECT_NE(other, W);
}

// Both are at rounding of the exact flow: 64 steps of order 12, of size 1/40.
TEST(CoRotatingFrame, CommutesWithTheExactFlow) {
  const Scene scene = smooth_scene(n);
  const Matrix fixed = integrated(*named("group6", scene), scene.initial, 0.025, 64);
  const Matrix turned = integrated(*named("group6_frame", scene), scene.initial, 0.025, 64);
  EXPECT_LE(largest_difference(fixed, turned), 1e-12);

  // Without the turn at the end it is another matrix.
  CoRotatingFrame frame(std::dynamic_pointer_cast<const EulerZeitlin>(scene.flow));
  const auto inner = made(integrator_entry("group6"), *frame.flow());
  EXPECT_GE(largest_difference(fixed, integrated(*inner, scene.initial, 0.025, 64)), 1e-2);
}

// W with l = 1 alone commutes with its generator: it is turned to itself.  The steps are twice as
// long as those at which RK4 without the frame lets rounding grow (h‖ad_B‖ = 6.4).
TEST(CoRotatingFrame, AStateOfRotationAloneTurnsRigidlyAtAnyStep) {
  const Scene scene = smooth_scene(n, HbarConvention::paper, {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}});
  for (const std::string name : {"rk4_frame", "rkmk4_frame", "group2_frame", "kahan_li6_frame"}) {
    const Matrix W = integrated(*named(name, scene), scene.initial, 1.5, 10);
    EXPECT_LE(largest_difference(W, scene.initial), 1e-12) << name;
  }
}

// Its small disturbances are turned with it, which the frame does exactly and RK4 does not.
TEST(CoRotatingFrame, ADisturbedRotationTurnsMoreExactlyThanWithoutTheFrame) {
  const Scene scene = smooth_scene(n, HbarConvention::paper,
                                   {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {3, 2, {1e-6, -2e-6}}});
  const Matrix exact = integrated(*named("group8", scene), scene.initial, 0.05, 20);
  const auto error = [&](const std::string& name) {
    return largest_difference(integrated(*named(name, scene), scene.initial, 0.25, 4), exact);
  };
  EXPECT_LE(error("rk4_frame"), 0.1 * error("rk4"));
}

class InTheFrame : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  // The angular momentum is an invariant of a step if the step is linear in commutators [B, W] of
  // its own stages.  The exponentials of explicit methods are not, and neither is a projection.
  static bool keeps_rotation() { return !GetParam().keeps.isospectral || !GetParam().is_explicit; }
};

TEST_P(InTheFrame, TheRotationIsKeptToRounding) {
  for (const Scene& scene : {smooth_scene(n), rough_scene(n)}) {
    const Matrix W = integrated(*made(GetParam(), *scene.flow), scene.initial, 0.05, 20);
    EXPECT_LE(largest_difference(rotation_part(W), rotation_part(scene.initial)),
              keeps_rotation() ? 1e-12 : 1e-4)
        << scene.name;
  }
}

TEST_P(InTheFrame, StepsAreThoseOfARunAndWatchingChangesNothing) {
  const Scene scene = smooth_scene(n);
  const auto make = [&] { return made(GetParam(), *scene.flow); };
  Matrix W = scene.initial, watched = scene.initial, stepped = scene.initial;
  run(*make(), W, 0.1, 5);
  std::vector<Matrix> states;
  run(*make(), watched, 0.1, 5,
      [&](long, const Matrix& state, const StepReport&) { states.push_back(state); });
  EXPECT_EQ(watched, W);
  EXPECT_EQ(states.back(), W);
  const auto stepping = make();
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_EQ(stepping->step(stepped, 0.1).status, Status::converged);
    EXPECT_LE(largest_difference(stepped, states[k]), keeps_rotation() ? 1e-12 : 1e-9);
  }
}

// The frame has turned by the time of all steps, whatever their sizes.
TEST_P(InTheFrame, StepsOfSeveralSizesAreThoseOfStepsOneByOne) {
  const Scene scene = smooth_scene(n);
  const std::vector<double> sizes = {0.1, 0.05, 0.05, 0.1};
  const auto together = made(GetParam(), *scene.flow);
  const auto stepping = made(GetParam(), *scene.flow);
  Matrix one_by_one = scene.initial, W = scene.initial;
  together->set_state(W);
  for (const double h : sizes) {
    ASSERT_EQ(together->step(h).status, Status::converged);
    ASSERT_EQ(stepping->step(one_by_one, h).status, Status::converged);
    together->state(W);
    EXPECT_LE(largest_difference(W, one_by_one), keeps_rotation() ? 1e-12 : 1e-9) << h;
  }

  // Turned by the last step alone, it would lag by 0.2.
  CoRotatingFrame frame(std::dynamic_pointer_cast<const EulerZeitlin>(scene.flow));
  const CoRotatingFrame::Rate rate = frame.rate(scene.initial);
  Matrix lagging(n, n);
  frame.leave(rate, -0.2, W, lagging);
  EXPECT_GE(largest_difference(lagging, one_by_one), 1e-2);
}

// A state that is amended goes on from where it is, its rotation changed or not.
TEST_P(InTheFrame, AmendedStatesAreThoseOfStepsOneByOne) {
  const Scene scene = smooth_scene(n);
  const auto together = made(GetParam(), *scene.flow);
  const auto stepping = made(GetParam(), *scene.flow);
  Matrix one_by_one = scene.initial, W = scene.initial;
  together->set_state(W);
  for (const Matrix& force :
       {Matrix(0.2 * scene.initial), random_skew_hermitian(n, 6),
        Matrix(0.3 * rotation_part(random_skew_hermitian(n, 7))), Matrix(Matrix::Zero(n, n))}) {
    for (const double h : {0.1, 0.05}) ASSERT_EQ(together->step(h).status, Status::converged);
    W = together->state() + 0.1 * force;
    together->amend_state(W);
    EXPECT_LE(largest_difference(together->state(), W), 1e-14);
    EXPECT_NEAR(together->energy(), scene.flow->energy(W), 1e-13);

    for (const double h : {0.1, 0.05}) {
      ASSERT_EQ(stepping->step(one_by_one, h).status, Status::converged);
    }
    one_by_one += 0.1 * force;
    EXPECT_LE(largest_difference(W, one_by_one), keeps_rotation() ? 1e-12 : 1e-9);
  }
}

std::vector<IntegratorEntry> frames() {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.co_rotating) found.push_back(entry);
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(List, InTheFrame, ::testing::ValuesIn(frames()),
                         ::testing::PrintToStringParamName());

// Without it a new frame would begin, in which the past steps are those of another state.
TEST(FrameIntegrator, PastStepsPredictAnAmendedState) {
  const Scene scene = smooth_scene(17);
  const auto attempt_after = [&](bool amend) {
    const auto integrator = make_integrator(scene.flow, "group2_frame", {.solver = Solver::fast});
    integrator->set_state(scene.initial);
    StepReport report;
    for (int k = 0; k < 8; ++k) {
      report = integrator->step(0.1);
      EXPECT_EQ(report.status, Status::converged);
      const Matrix W = 0.9999 * integrator->state();
      amend ? integrator->amend_state(W) : integrator->set_state(W);
    }
    return std::pair(name(report.attempt), report.sweeps);
  };
  const auto [amended, fewer] = attempt_after(true);
  const auto [set, more] = attempt_after(false);
  EXPECT_EQ(amended, "predicted Newton");
  EXPECT_EQ(set, "cold Newton");
  EXPECT_LT(fewer, more);
}

TEST(FrameIntegrator, IsForEulerZeitlinOnly) {
  const ConjugationFlow flow(QuadraticAlgebra::skew_hermitian(5), 1);
  expect_refused([&] { made(integrator_entry("rk4_frame"), flow); }, "Euler-Zeitlin only");
}

// A run that an exception ends leaves the last good state, turned.
TEST(Run, LeavesTheLastGoodStateWhenItIsEndedByAnException) {
  const Scene scene = smooth_scene(n);
  for (const std::string name : {"group2", "group2_frame"}) {
    Matrix expected = scene.initial, W = scene.initial;
    run(*named(name, scene), expected, 0.1, 3);
    const auto end_after_three = [](const RunReport& total) {
      if (total.steps == 3) throw std::runtime_error("ended");
      return true;
    };
    EXPECT_THROW(run_while(*named(name, scene), W, 0.1, 9, end_after_three), std::runtime_error);
    EXPECT_EQ(W, expected) << name;
  }
}

}  // namespace
}  // namespace isosyrk::testing
