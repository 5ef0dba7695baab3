// Steady states and rigid rotations: modes of one degree l, which are exact solutions, and the same
// with a little perturbation.  All methods of the list, published and fast.
#include <cmath>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/split/split_matrix.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Modes of one degree: B(W) is a multiple of W.
Matrix of_degree(Index n, int l, bool is_zonal = false) {
  std::vector<Mode> modes = {{l, 0, 0.7}};
  for (int m = 1; m <= l && !is_zonal; ++m) {
    modes.push_back({l, m, Complex(0.3 * std::cos(1.0 + m), 0.4 * std::sin(2.0 * m))});
  }
  return vorticity_from_modes(modes, n);
}

// ‖B(W)‖₂
double size_of_B(const Flow& flow, const Matrix& W) {
  return spectral_norm(flow.dense_generator(W));
}

using Numbers = std::vector<double>;
const Numbers perturbations = {0.0, 1e-4, 1e-8, 1e-11, 1e-14};
constexpr double tolerances[] = {1e-13, 1e-8};

// Half the step at which the iteration of a method ceases to contract by linear theory, or this
// h‖B‖ if that is less.  Of fine scales B is small, and h‖B‖ alone would allow steps that turn
// large scales many times.
double step_for(const IntegratorEntry& entry, const Flow& flow, const Matrix& W, double size) {
  double h = std::min(size / size_of_B(flow, W), 1.0);
  if (entry.linear_limit) {
    h = std::min(h, 0.5 * entry.linear_limit(spectrum(flow.dense_generator(W))));
  }
  return h;
}

struct FinishedRun {
  RunReport report;
  Matrix first;  // after one step
  Matrix W;
};

FinishedRun run_of(const IntegratorEntry& entry, const Flow& flow, const Matrix& W0,
                   double tolerance, double h, long steps) {
  FinishedRun result = {{}, W0, W0};
  const auto observe = [&](long step, const Matrix& W, const StepReport&) {
    if (step == 1) result.first = W;
  };
  result.report = run(*made(entry, flow, {.tolerance = tolerance}), result.W, h, steps, observe);
  EXPECT_TRUE(result.report.converged())
      << name(result.report.status) << " at step " << result.report.failed_step;
  return result;
}

bool is_gauss(const IntegratorEntry& entry) {
  return !entry.is_explicit && !entry.keeps.spectrum_at_any_tolerance;
}

class EachMethodAtASteadyState : public ::testing::TestWithParam<std::string> {
 protected:
  // Runs from modes of each degree, perturbed, published and fast.
  void run_all(Index n, double size, long steps, const Numbers& perturbed = perturbations) const {
    const EulerZeitlin flow(n, HbarConvention::paper);
    const Matrix smooth = smooth_scene(n).initial;
    for (const int l : {1, 2, 3, static_cast<int>(n) / 2, static_cast<int>(n) - 1}) {
      for (const double perturbation : perturbed) {
        const Matrix W0 = of_degree(n, l) + perturbation * smooth;
        const double h = step_for(entry, flow, W0, size);
        const double same_h = h * size_of_B(flow, W0) / size_of_B(flow, smooth);
        for (const double tolerance : tolerances) {
          SCOPED_TRACE(::testing::Message() << "n = " << n << ", l = " << l << " + " << perturbation
                                            << ", h|B| = " << size << ", " << tolerance);
          const long sweeps = expect_the_same(flow, W0, tolerance, h, steps);
          // Plain iteration, which is all that a published form has, contracts by h‖W‖.
          if (entry.is_explicit || !entry.has_fast_form()) continue;
          const FinishedRun moving = run_of(fast_form(), flow, smooth, tolerance, same_h, steps);
          EXPECT_LE(sweeps, moving.report.sweeps + most_more_sweeps * substeps() * steps);
        }
      }
    }
  }

  const IntegratorEntry& entry = integrator_entry(GetParam());

 private:
  // A substep takes at most so many sweeps more than one of the smooth scene with the same h‖B‖,
  // where h‖W‖, by which an error of Ω or of the stages contracts, is up to l (l + 1) / 2 times
  // smaller.
  static constexpr long most_more_sweeps = 2;
  long substeps() const { return entry.family == Family::composition ? entry.stages : 1; }

  IntegratorEntry fast_form() const { return entry.has_fast_form() ? fast_entry(entry) : entry; }

  // Ten tolerances after one step, three times steps x tolerance after more.  The fast form of
  // rkmk4 may leave out a hundredth of its error too, which is O(h⁵) of the perturbation.  Returns
  // the sweeps of the fast form, or of the published one if there is none.
  long expect_the_same(const Flow& flow, const Matrix& W0, double tolerance, double h,
                       long steps) const {
    const FinishedRun published = run_of(entry, flow, W0, tolerance, h, steps);
    if (!entry.has_fast_form()) return published.report.sweeps;
    const FinishedRun fast = run_of(fast_form(), flow, W0, tolerance, h, steps);
    const auto expect_near = [&](const Matrix& W, const Matrix& expected, long count) {
      const bool leaves_out = entry.family == Family::munthe_kaas;
      const double of_method = leaves_out ? 1e-2 * (expected - W0).norm() / W0.norm() : 0.0;
      const double allowed = std::max(10.0, 3.0 * static_cast<double>(count)) * tolerance;
      EXPECT_LE((W - expected).norm() / W0.norm(), allowed + of_method) << count;
    };
    expect_near(fast.first, published.first, 1);
    expect_near(fast.W, published.W, steps);
    return fast.report.sweeps;
  }
};

std::vector<std::string> names_of_integrators() {
  std::vector<std::string> names;
  for (const IntegratorEntry& entry : integrators()) names.push_back(entry.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, EachMethodAtASteadyState, ::testing::ValuesIn(names_of_integrators()),
                         [](const auto& tested) { return tested.param; });

TEST_P(EachMethodAtASteadyState, ConvergesToOneAnswerAtSteadyStatesAndNearThem) {
  run_all(9, 0.5, 4);
  run_all(17, 1.0, 4);
}
TEST_P(EachMethodAtASteadyState, ConvergesToOneAnswerAtLargeOnes) {
  run_all(33, 0.5, 4);
  run_all(65, 0.5, 2, {1e-8});
}
TEST_P(EachMethodAtASteadyState, ConvergesToOneAnswerAtTheLargestOnes) {
  // The other Gauss forms take minutes.
  const bool is_slow = is_gauss(entry) || !entry.has_fast_form();
  if (!is_slow || entry.name == "algebra1") run_all(129, 0.5, 1, {1e-8});
}

// Exponential, Magnus and explicit methods stay where they are, but for what each step rounds: Ω by
// h‖B‖ units of rounding, and W with it.  Gauss methods do so if m = 0: a stage is a polynomial in
// W, of which B is a function of W again only if all are diagonal.
TEST_P(EachMethodAtASteadyState, StaysAtASteadyState) {
  constexpr Index n = 17;
  constexpr long steps = 5;
  const EulerZeitlin flow(n, HbarConvention::paper);
  for (const int l : {1, 2, 3, 8, 16}) {
    const Matrix W0 = of_degree(n, l, is_gauss(entry));
    for (const double size : {0.25, 1.0}) {
      const double h = step_for(entry, flow, W0, size);
      for (const IntegratorEntry& form : forms_of(entry)) {
        SCOPED_TRACE(::testing::Message() << form.name << ", l = " << l << ", h|B| = " << size);
        const Matrix W = run_of(form, flow, W0, 1e-13, h, steps).W;
        // A step rounds W itself by a few units, and an implicit one is solved to the tolerance.
        const double rounding = 2.2e-16 * (10.0 + 10.0 * size * std::sqrt(static_cast<double>(n)));
        const double solved = entry.is_explicit ? 0.0 : 1e-13;
        EXPECT_LE((W - W0).norm() / W0.norm(), static_cast<double>(steps) * (rounding + solved));
      }
    }
  }
}

// The control: a state of two degrees moves.
TEST(SteadyStates, OnesOfTwoDegreesAreNotSteady) {
  const EulerZeitlin flow(17, HbarConvention::paper);
  const Matrix W0 = of_degree(17, 2) + of_degree(17, 3);
  const Matrix W = run_of(integrator_entry("magnus5"), flow, W0, 1e-13, 0.2, 5).W;
  EXPECT_GT((W - W0).norm(), 1e-2 * W0.norm());
}

// ---- rigid rotations in the frame

class EachExponentialInTheFrame : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, EachExponentialInTheFrame,
                         ::testing::Values("elp2_frame", "elp4_frame", "elp6_frame"),
                         [](const auto& tested) { return tested.param; });

// In the frame Ω is rounding.  It used to stagnate there, at the tolerance times an Ω of 1e-16.
TEST_P(EachExponentialInTheFrame, SolvesARigidRotationInAsManySweepsAsTheSmoothScene) {
  for (const Index n : {9, 17, 33}) {
    const EulerZeitlin flow(n, HbarConvention::paper);
    const Matrix W0 = vorticity_from_modes({{1, 0, 0.3}, {1, 1, {0.2, 0.1}}}, n);
    const Matrix smooth = smooth_scene(n).initial;
    for (const IntegratorEntry& form : forms_of(integrator_entry(GetParam()))) {
      for (const double tolerance : tolerances) {
        for (const double size : {0.4, 1.6}) {
          SCOPED_TRACE(::testing::Message()
                       << form.name << " " << n << " " << tolerance << " " << size);
          const double h = size / size_of_B(flow, W0);
          const FinishedRun still = run_of(form, flow, W0, tolerance, h, 40);
          const FinishedRun moving =
              run_of(form, flow, smooth, tolerance, size / size_of_B(flow, smooth), 40);
          EXPECT_LE(still.report.sweeps, moving.report.sweeps);
          EXPECT_LE((still.W - W0).norm() / W0.norm(), 40 * 1e-14);
        }
      }
    }
  }
}

// What the frame leaves out of B, seen by both kinds of storage, is B of the part with l = 1.
TEST(RotationLeftOut, IsThatOfTheFrameAndNoneWithoutIt) {
  for (const Index n : {2, 9, 34}) {
    const auto flow = std::make_shared<EulerZeitlin>(n, HbarConvention::standard);
    const CoRotatingFrame frame(flow);
    const Matrix W = rough_scene(n).initial;
    const double expected = (flow->dense_generator(W) - frame.flow()->dense_generator(W)).norm();
    EXPECT_NEAR(frame.flow()->rotation_left_out(W), expected, 1e-13 * expected);
    EXPECT_NEAR(frame.flow()->split_generator()->rotation_left_out(SplitMatrix(W)), expected,
                1e-13 * expected);
    EXPECT_EQ(flow->rotation_left_out(W), 0.0);
    EXPECT_EQ(flow->split_generator()->rotation_left_out(SplitMatrix(W)), 0.0);
  }
}

}  // namespace
}  // namespace isosyrk::testing
