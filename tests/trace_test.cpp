// The trace of a state, which integrators set aside where the flow ignores it.
#include "isosyrk/integrators/state_trace.h"

#include <fmt/format.h>

#include "isosyrk/catalogue/make_integrator.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

// W + icI.
Matrix with_trace(Matrix W, double c) {
  W.diagonal().array() += Complex(0.0, c);
  return W;
}

// The flow of a scene, which says nothing of its trace.
FlowOf silent(const Scene& scene) {
  return {scene.flow->algebra(),
          [flow = scene.flow](const Matrix& W, Matrix& B) { flow->generator(W, B); },
          Generator::linear, true};
}

TEST(TracePart, IsThatOfTheDiagonal) {
  const Matrix W = random_skew_hermitian(9, 1);
  const double own = W.diagonal().imag().mean();
  for (const double c : {1e-12, 0.3, -7.0, 1e8}) {
    const double part = trace_part(with_trace(W, c));
    EXPECT_NEAR(part, own + c, epsilon * (1.0 + std::abs(c)));
    // Norms whose squares overflow or underflow.
    for (const double factor : {0x1p-600, 0x1p600}) {
      EXPECT_EQ(trace_part(factor * with_trace(W, c)), factor * part);
    }
  }
  for (const double c : {0.3, -1e-9, 1e8 + 1.0}) {
    EXPECT_EQ(trace_part(with_trace(Matrix::Zero(7, 7), c)), c) << "nothing is left of icI";
  }
}

TEST(TracePart, IsNoneWhereItIsRounding) {
  for (const Index n : {5, 9, 17, 33, 49, 65, 129, 257}) {
    for (const HbarConvention hbar : {HbarConvention::paper, HbarConvention::standard}) {
      EXPECT_EQ(trace_part(smooth_scene(n, hbar).initial), 0.0) << n;
      EXPECT_EQ(trace_part(rough_scene(n, hbar).initial), 0.0) << n;
    }
  }
  Matrix W = smooth_scene(9).initial;
  EXPECT_EQ(trace_part(with_trace(W, 0.5 * 9.0 * epsilon * W.norm())), 0.0);
  EXPECT_NE(trace_part(with_trace(W, 2.0 * 9.0 * epsilon * W.norm())), 0.0);
  EXPECT_EQ(trace_part(Matrix::Zero(3, 3)), 0.0);
  for (const double bad : {std::nan(""), infinity}) {
    W(4, 4) = Complex(0.0, bad);
    EXPECT_EQ(trace_part(W), 0.0);
  }
}

// A flow that ignores the trace has the same B with any; the others of J = I have another one.
TEST(AFlow, IgnoresTheTraceIfItSaysSo) {
  for (const SceneCase& tested : tested_scenes()) {
    const Scene scene = scene_by_name(tested.name, tested.parameters);
    const Flow& flow = *scene.flow;
    if (dynamic_cast<const RealFlow*>(&flow) != nullptr) {
      EXPECT_FALSE(flow.ignores_trace()) << "a real W in g has none";
      continue;
    }
    const Matrix B = flow.dense_generator(scene.initial);
    const Matrix moved = flow.dense_generator(with_trace(scene.initial, 10.0));
    if (flow.ignores_trace()) {
      EXPECT_TRUE(flow.algebra().is_skew_hermitian()) << "icI is in g";
      EXPECT_LE(largest_difference(moved, B), 100.0 * epsilon * B.norm()) << scene.name;
    } else {
      EXPECT_GE(largest_difference(moved, B), 1e-3 * B.norm()) << scene.name;
    }
    EXPECT_EQ(flow.ignores_trace(), is_euler_zeitlin(tested.name)) << scene.name;
  }
}

// By n and method: at n = 9 both forms of each method, at n = 49 the fast forms, which cut bands.
class EachTrace : public ::testing::TestWithParam<std::tuple<Index, IntegratorEntry>> {
 protected:
  static constexpr double h = 0.1;
  static constexpr int steps = 10;

  // Calls test(make, W₀, c, bound): the bound is a unit in the last place of c for each step, and
  // what the iteration leaves for contractions up to 0.8.
  template <class Test>
  static void for_each_trace(const Test& test) {
    const auto& [n, method] = GetParam();
    for (const IntegratorEntry& entry : forms_of(method)) {
      if (n == 9 || entry.is_fast) {
        const Scene scene = smooth_scene(n);
        for (const double c : {3.0, 100.0, -1e4}) {
          SCOPED_TRACE(fmt::format("{} n = {} c = {}", entry.name, n, c));
          test([&] { return made(entry, *scene.flow); }, scene.initial, c,
               steps * (epsilon * std::abs(c) + 1e-13 / (1.0 - 0.8)));
        }
      }
    }
  }
};

TEST_P(EachTrace, MovesWithTheStateThatHasNone) {
  for_each_trace([](const auto& make, const Matrix& W0, double c, double bound) {
    const auto integrator = make(), expected = make();
    integrator->set_state(with_trace(W0, c));
    expected->set_state(W0);
    for (int k = 0; k < steps; ++k) {
      ASSERT_EQ(integrator->step(h).status, Status::converged);
      ASSERT_EQ(expected->step(h).status, Status::converged);
      const Matrix W = with_trace(integrator->state(), -c);
      EXPECT_LE(largest_difference(W, expected->state()), bound) << k;
      EXPECT_NEAR(integrator->energy(), expected->energy(), bound);
    }
  });
}

TEST_P(EachTrace, IsReturnedBitForBitUntilAStepIsMade) {
  for_each_trace([](const auto& make, const Matrix& W0, double c, double) {
    const auto integrator = make();
    Matrix W = with_trace(W0, c);
    W(2, 2) = Complex(0.0, 1e-18);  // rounded away beside c
    integrator->set_state(W);
    EXPECT_TRUE(integrator->state() == W);
    W *= 1.1;
    integrator->amend_state(W);
    EXPECT_TRUE(integrator->state() == W);
    const Matrix before = W;
    EXPECT_NE(integrator->step(W, 1e200).status, Status::converged);
    EXPECT_TRUE(W == before) << "a lone step that fails";
    EXPECT_NE(integrator->step(1e200).status, Status::converged);
    EXPECT_TRUE(integrator->state() == before) << "a step that fails";
  });
}

// A trace that comes and goes between steps, and lone steps with one.
TEST_P(EachTrace, MayBeAmendedAndSteppedAlone) {
  for_each_trace([](const auto& make, const Matrix& W0, double c, double bound) {
    const auto integrator = make(), expected = make();
    integrator->set_state(W0);
    expected->set_state(W0);
    Matrix alone = with_trace(W0, c), expected_alone = W0;
    double now = 0.0;
    for (const double next : {c, 2.0 * c, 0.0, 1.0}) {
      ASSERT_EQ(integrator->step(h).status, Status::converged);
      ASSERT_EQ(expected->step(h).status, Status::converged);
      integrator->amend_state(with_trace(0.99 * with_trace(integrator->state(), -now), next));
      expected->amend_state(0.99 * expected->state());
      now = next;
      const Matrix W = with_trace(integrator->state(), -now);
      EXPECT_LE(largest_difference(W, expected->state()), 2.0 * bound);

      ASSERT_EQ(integrator->step(alone, h).status, Status::converged);
      ASSERT_EQ(expected->step(expected_alone, h).status, Status::converged);
      EXPECT_LE(largest_difference(with_trace(alone, -c), expected_alone), bound);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Small, EachTrace,
                         ::testing::Combine(::testing::Values(9),
                                            ::testing::ValuesIn(integrators())),
                         name_of_method);
INSTANTIATE_TEST_SUITE_P(Large, EachTrace,
                         ::testing::Combine(::testing::Values(49),
                                            ::testing::ValuesIn(fast_integrators())),
                         name_of_method);

// Negative control: where the trace is not set aside, ISOSYRK methods lose accuracy with it, and
// methods that conjugate by exponentials do not.  Errors against c = 0 at T = 1, h = 0.1.
TEST(ATraceThatIsNotSetAside, CostsGaussMethodsTheirAccuracy) {
  const Scene scene = smooth_scene(17);
  const FlowOf flow = silent(scene);
  const auto end = [&](const char* method, const Flow& of, double c) {
    const Matrix W =
        integrated(*made(integrator_entry(method), of), with_trace(scene.initial, c), 0.1, 10);
    return with_trace(W, -c);
  };
  for (const char* method : {"algebra1", "group2"}) {
    const Matrix expected = end(method, *scene.flow, 0.0);
    EXPECT_EQ(end(method, flow, 0.0), expected);
    EXPECT_LE(largest_difference(end(method, *scene.flow, 100.0), expected), 1e-12) << method;
    EXPECT_GE(largest_difference(end(method, flow, 100.0), expected), 1e-5) << method;
  }
  EXPECT_GE(largest_difference(end("algebra1", flow, 100.0), end("algebra1", flow, 0.0)), 2e-2);
  for (const char* method : {"elp4", "magnus5", "rk4", "rkmk4"}) {
    EXPECT_LE(largest_difference(end(method, flow, 100.0), end(method, flow, 0.0)), 1e-11)
        << method;
  }
}

TEST(ATraceThatIsNotSetAside, EndsTheConvergenceOfGaussMethods) {
  const Scene scene = smooth_scene(17);
  const Matrix W0 = with_trace(scene.initial, 1e4);
  const FlowOf flow = silent(scene);
  Matrix W = W0;
  EXPECT_FALSE(run(*made(integrator_entry("group2"), flow), W, 0.1, 10).converged());
  W = W0;
  EXPECT_TRUE(run(*made(integrator_entry("group2"), *scene.flow), W, 0.1, 10).converged());
}

struct Interrupted {};

TEST(ATrace, IsInTheMatrixOfALoneStepThatAnExceptionEnds) {
  const Scene scene = smooth_scene(9);
  for (const Solver solver : {Solver::published, Solver::fast}) {
    const auto interrupt = [] { throw Interrupted(); };
    const auto integrator = make_integrator(
        scene.flow, "group2_frame", {.solver = solver, .iteration = {.after_sweep = interrupt}});
    const Matrix before = with_trace(scene.initial, 0.7);
    Matrix W = before;
    EXPECT_THROW(integrator->step(W, 0.1), Interrupted);
    EXPECT_TRUE(W == before);
  }
}

}  // namespace
}  // namespace isosyrk::testing
