#include "isosyrk/simulation/run.h"

#include <functional>
#include <type_traits>
#include <vector>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/catalogue/make_integrator.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class Scripted final : public IntegratorIn<Complex> {
 public:
  using Advance = std::function<StepReport(const Matrix& W0, Matrix& W1)>;
  Scripted(const SharedFlow& flow, Advance advance)
      : IntegratorIn(flow), advance_(std::move(advance)) {}

 protected:
  StepReport advance(const Matrix& W0, double, Matrix& W1) override { return advance_(W0, W1); }

 private:
  Advance advance_;
};

TEST(Run, AddsUpWhatItsStepsReport) {
  const Scene scene = smooth_scene(9);
  const auto integrator = gauss(Formulation::group, *scene.flow, 2);
  Matrix W = scene.initial;
  long observed = 0;
  long sweeps = 0;
  Matrix last;
  const RunReport report =
      run(*integrator, W, 0.1, 7, [&](long k, const Matrix& V, const StepReport& step) {
        EXPECT_EQ(k, ++observed);
        last = V;
        sweeps += step.sweeps;
      });
  EXPECT_EQ(last, W);
  EXPECT_TRUE(report.converged());
  EXPECT_EQ(report.steps, 7);
  EXPECT_EQ(report.failed_step, 0);
  EXPECT_EQ(report.sweeps, sweeps);
  EXPECT_DOUBLE_EQ(report.sweeps_per_step(), static_cast<double>(sweeps) / 7.0);
}

TEST(Run, InTwoPartsHasTheTotalsOfOne) {
  const Scene scene = smooth_scene(9);
  const auto in_parts = [&](std::initializer_list<long> parts) {
    const auto integrator = gauss(Formulation::group, *scene.flow, 2);
    Matrix W = scene.initial;
    RunReport total;
    for (const long steps : parts) total.append(run(*integrator, W, 0.1, steps));
    return total;
  };
  const RunReport whole = in_parts({7});
  for (const RunReport& parts : {in_parts({3, 4}), in_parts({7, 0}), in_parts({0, 7})}) {
    EXPECT_EQ(parts.steps, whole.steps);
    EXPECT_EQ(parts.sweeps, whole.sweeps);
    EXPECT_EQ(parts.last_change, whole.last_change);
    EXPECT_EQ(parts.contraction, whole.contraction);
    EXPECT_EQ(parts.work.products, whole.work.products);
    EXPECT_EQ(parts.failed_step, 0);
  }
  RunReport failing = whole;
  failing.append({.status = Status::diverged, .steps = 2, .failed_step = 3});
  EXPECT_EQ(failing.status, Status::diverged);
  EXPECT_EQ(failing.steps, 9);
  EXPECT_EQ(failing.failed_step, 10);
}

TEST(Run, StopsAtTheFirstStepThatFailsAndKeepsTheLastGoodState) {
  const Scene scene = smooth_scene(5);
  int calls = 0;
  Scripted integrator(scene.flow, [&](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = 2.0 * W0;
    return {.status = ++calls == 3 ? Status::stagnated : Status::converged,
            .sweeps = 1,
            .last_change = 0.25};
  });
  Matrix W = scene.initial;
  const RunReport report = run(integrator, W, 0.1, 10);
  EXPECT_EQ(report.status, Status::stagnated);
  EXPECT_EQ(report.failed_step, 3);
  EXPECT_EQ(report.steps, 2);
  EXPECT_EQ(report.last_change, 0.25);
  EXPECT_EQ(W, 4.0 * scene.initial);
}

TEST(Run, ReportsTheLargestContractionOfItsSteps) {
  const Scene scene = smooth_scene(5);
  const std::vector<double> contractions = {0.2, 0.7, 0.3, 0.9};
  std::size_t next = 0;
  Scripted integrator(scene.flow, [&](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = W0;
    const double contraction = contractions[next++];
    return {.status = contraction < 0.8 ? Status::converged : Status::stagnated,
            .contraction = contraction};
  });
  const auto largest = [&](long steps) {
    next = 0;
    Matrix W = scene.initial;
    return run(integrator, W, 0.1, steps).contraction;
  };
  EXPECT_EQ(largest(1), 0.2);
  EXPECT_EQ(largest(3), 0.7);
  EXPECT_EQ(largest(4), 0.9) << "that of a step that failed, too";
}

TEST(Step, IsDivergedWhenTheUpdateOverflowsAfterItsStagesConverged) {
  const Scene scene = smooth_scene(5);
  Scripted integrator(scene.flow, [](const Matrix& W0, Matrix& W1) -> StepReport {
    W1 = W0;
    W1(0, 0) = std::numeric_limits<double>::infinity();
    return {};
  });
  Matrix W = scene.initial;
  EXPECT_EQ(integrator.step(W, 0.1).status, Status::diverged);
  EXPECT_EQ(W, scene.initial);
}

// A matrix that does not lie in memory as a Matrix does is no view: a copy would be advanced
// instead.
static_assert(std::is_convertible_v<Matrix&, MatrixView>);
static_assert(std::is_convertible_v<Eigen::Map<Matrix>, MatrixView>);
static_assert(std::is_convertible_v<Eigen::Block<Matrix>, MatrixView>);
static_assert(!std::is_convertible_v<const Matrix&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::MatrixXcd&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::Map<Eigen::MatrixXcd>, MatrixView>);
static_assert(!std::is_convertible_v<RealMatrix&, MatrixView>);
static_assert(!std::is_convertible_v<Eigen::Transpose<Matrix>, MatrixView>);

TEST(Step, AdvancesWhatAViewShowsAndNothingBesideIt) {
  constexpr Index n = 9;
  const Scene scene = smooth_scene(n);
  for (const IntegratorEntry& entry : integrators()) {
    const auto make = [&] { return entry.make(scene.flow, {}, ProductBackend::openblas); };
    Matrix W = scene.initial;
    make()->step(W, 0.1);
    EXPECT_NE(W, scene.initial);

    Matrix frame = Matrix::Constant(n + 3, n + 5, 7.0);
    frame.block(1, 2, n, n) = scene.initial;
    make()->step(frame.block(1, 2, n, n), 0.1);
    EXPECT_EQ(Matrix(frame.block(1, 2, n, n)), W) << entry.name;
    frame.block(1, 2, n, n).setConstant(7.0);
    EXPECT_EQ(frame, Matrix::Constant(n + 3, n + 5, 7.0)) << entry.name;

    // At an address that no allocator would choose.
    std::vector<Complex> numbers(n * n + 1);
    Eigen::Map<Matrix> mapped(numbers.data() + 1, n, n);
    mapped = scene.initial;
    make()->step(mapped, 0.1);
    EXPECT_EQ(Matrix(mapped), W) << entry.name;
  }
}

TEST(Step, RefusesWrongSizesAndLengths) {
  const Scene scene = smooth_scene(5);
  const auto integrator = gauss(Formulation::group, *scene.flow, 1);
  Matrix W = scene.initial, small = Matrix::Zero(4, 4);
  EXPECT_THROW(integrator->step(small, 0.1), std::invalid_argument);
  for (const double h : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(integrator->step(W, h), std::invalid_argument);
  }
}

// Every integrator of the list, as published and as a fast form if it has one.
std::vector<IntegratorEntry> both_forms() {
  std::vector<IntegratorEntry> all;
  for (const IntegratorEntry& entry : integrators()) {
    for (const IntegratorEntry& form : forms_of(entry)) all.push_back(form);
  }
  return all;
}

// A flow by reference, which might end before the integrator, does not compile.
template <class Argument>
constexpr bool makes_from = requires(Argument flow) {
  make_integrator(flow, "group2");
};
static_assert(makes_from<SharedFlow>);
static_assert(makes_from<std::shared_ptr<const EulerZeitlin>>);
static_assert(!makes_from<const Flow&>);

TEST(Integrator, KeepsItsFlowAliveAndNoLonger) {
  for (const IntegratorEntry& entry : both_forms()) {
    std::weak_ptr<const Flow> flow;
    Matrix W;
    const auto make = [&] {
      const Scene scene = smooth_scene(9);
      flow = scene.flow;
      W = scene.initial;
      return entry.make(scene.flow, {}, ProductBackend::openblas);
    };
    make();
    EXPECT_TRUE(flow.expired()) << entry.name;
    const auto integrator = make();
    EXPECT_FALSE(flow.expired()) << entry.name;
    EXPECT_TRUE(run(*integrator, W, 0.1, 2).converged()) << entry.name;
  }
}

TEST(Integrator, RefusesNoFlow) {
  for (const Solver solver : {Solver::published, Solver::fast}) {
    for (const char* name : {"group2", "algebra1", "yoshida4", "rk4", "group2_frame"}) {
      expect_refused([&] { make_integrator(nullptr, name, {.solver = solver}); }, "flow is null");
    }
  }
  expect_refused([] { integrator_entry("rk4").make({}, {}, ProductBackend::openblas); }, "is null");
}

// The state of a run, and where its next steps lead.
class BesideARun {
 public:
  BesideARun(const IntegratorEntry& entry, const Scene& scene)
      : entry_(entry), scene_(scene), integrator_(made()) {
    integrator_->set_state(scene.initial);
    advance(*integrator_);
  }
  // What is called between the steps of a run leaves the state and the steps after it as they are,
  // bit for bit.  The first of these would show past steps that were forgotten.
  template <class Call>
  void expect_undisturbed_by(const Call& call) {
    const auto alone = made();
    alone->set_state(scene_.initial);
    advance(*alone);
    const Matrix before = integrator_->state();
    ASSERT_EQ(before, alone->state());
    call(*integrator_);
    EXPECT_EQ(integrator_->state(), before) << entry_.name;
    for (int k = 0; k < 4; ++k) {
      const StepReport expected = alone->step(0.1), report = integrator_->step(0.1);
      EXPECT_EQ(report.attempt, expected.attempt) << entry_.name;
      EXPECT_EQ(report.sweeps, expected.sweeps) << entry_.name;
      EXPECT_EQ(report.contraction, expected.contraction) << entry_.name;
      EXPECT_EQ(report.work.products, expected.work.products) << entry_.name;
      EXPECT_TRUE(integrator_->state() == alone->state()) << entry_.name;
    }
  }
  std::unique_ptr<Integrator> made() const {
    return entry_.make(scene_.flow, {}, ProductBackend::openblas);
  }

 private:
  static void advance(Integrator& integrator) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(integrator.step(0.1).status, Status::converged);
  }
  IntegratorEntry entry_;
  Scene scene_;
  std::unique_ptr<Integrator> integrator_;
};

TEST(Integrator, ASingleStepIsThatOfANewOneAndLeavesTheRunAsItIs) {
  const Scene scene = smooth_scene(9), other = rough_scene(9);
  for (const IntegratorEntry& entry : both_forms()) {
    BesideARun run(entry, scene);
    run.expect_undisturbed_by([&](Integrator& integrator) {
      Matrix W = other.initial, expected = other.initial;
      EXPECT_EQ(integrator.step(W, 0.2).status, run.made()->step(expected, 0.2).status);
      EXPECT_EQ(W, expected) << entry.name;
      EXPECT_NE(W, other.initial) << entry.name;
      // One that fails leaves its W, too.
      W = other.initial;
      EXPECT_NE(integrator.step(W, 1e200).status, Status::converged) << entry.name;
      EXPECT_EQ(W, other.initial) << entry.name;
    });
  }
}

TEST(Integrator, ARunThatIsSetToAnotherStateDiffers) {
  const Scene scene = smooth_scene(9);
  const auto integrator = make_integrator(scene.flow, "group2");
  integrator->set_state(scene.initial);
  integrator->step(0.1);
  const Matrix before = integrator->state();
  integrator->set_state(rough_scene(9).initial);
  EXPECT_NE(integrator->state(), before);
}

TEST(Integrator, WhatItRefusesLeavesTheRunAsItIs) {
  const double nan = std::nan("");
  for (const char* name : {"smooth", "rigid_body", "spin_chain"}) {
    const Scene scene = scene_by_name(name, 6);
    for (const IntegratorEntry& entry : both_forms()) {
      if (!is_euler_zeitlin(name) && (entry.co_rotating || entry.is_fast)) continue;
      BesideARun(entry, scene).expect_undisturbed_by([&](Integrator& integrator) {
        Matrix W = 0.5 * scene.initial, small = Matrix::Zero(5, 5);
        EXPECT_THROW(integrator.step(nan), std::invalid_argument);
        EXPECT_THROW(integrator.step(W, nan), std::invalid_argument);
        EXPECT_THROW(integrator.set_state(small), std::invalid_argument);
        EXPECT_THROW(integrator.step(small, 0.1), std::invalid_argument);
        EXPECT_EQ(W, 0.5 * scene.initial);
        if (is_euler_zeitlin(name)) return;
        // Refused by its last entries, when storage has taken the others.
        W(5, 0) += Complex(0.0, 1.0);
        const Matrix refused = W;
        EXPECT_THROW(integrator.set_state(W), std::invalid_argument);
        EXPECT_THROW(integrator.step(W, 0.1), std::invalid_argument);
        EXPECT_EQ(W, refused);
      });
    }
  }
}

struct Interrupted {};

TEST(Integrator, AnExceptionInASingleStepLeavesItsStateAndTheRun) {
  static int sweeps_left;
  const auto interrupt = [] {
    if (--sweeps_left == 0) throw Interrupted();
  };
  const Scene scene = smooth_scene(9);
  for (const Solver solver : {Solver::published, Solver::fast}) {
    for (const char* name : {"group2", "algebra1", "yoshida4", "algebra2_frame"}) {
      const auto integrator = make_integrator(
          scene.flow, name, {.solver = solver, .iteration = {.after_sweep = interrupt}});
      sweeps_left = 0;
      integrator->set_state(scene.initial);
      integrator->step(0.1);
      const Matrix before = integrator->state(), other = rough_scene(9).initial;
      Matrix W = other;
      sweeps_left = 2;
      EXPECT_THROW(integrator->step(W, 0.1), Interrupted) << name;
      EXPECT_EQ(W, other) << name;
      EXPECT_EQ(integrator->state(), before) << name;
    }
  }
}

}  // namespace
}  // namespace isosyrk::testing
