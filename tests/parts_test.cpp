// Runs in parts, and lone steps beside a run: bit for bit what the run in one go is.
#include <fmt/format.h>

#include <functional>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/fast/exponential_system.h"
#include "isosyrk/fast/fast_integrator.h"
#include "isosyrk/fast/midpoint_system.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// All that a step reports, to be compared bit for bit.  Equivalent products are a difference of
// sums since construction, rounded to these.
std::string text(const StepReport& report) {
  return fmt::format("{} {} {} {:a} {:a} {} {:.9g} {} {}", name(report.status),
                     name(report.attempt), report.sweeps, report.last_change, report.contraction,
                     report.work.products, report.work.equivalent_products,
                     report.work.poisson_solves, report.work.projections);
}

// What can be seen of a run: reports of its steps and its last state.
struct Seen {
  std::vector<std::string> reports;
  Matrix W;
};

void expect_same(const Seen& seen, const Seen& expected, const std::string& what) {
  EXPECT_EQ(seen.reports, expected.reports) << what;
  EXPECT_TRUE(seen.W == expected.W) << what << ": " << largest_difference(seen.W, expected.W);
}

void advance(Integrator& integrator, double h, Seen& seen) {
  const StepReport report = integrator.step(h);
  EXPECT_EQ(report.status, Status::converged);
  seen.reports.push_back(text(report));
}

// Calls between(integrator, k) after step k.
template <class Between>
Seen stepped(Integrator& integrator, const Matrix& W0, const std::vector<double>& sizes,
             const Between& between) {
  Seen seen;
  integrator.set_state(W0);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    advance(integrator, sizes[k], seen);
    between(integrator, static_cast<int>(k) + 1);
  }
  seen.W = integrator.state();
  return seen;
}

Seen stepped(Integrator& integrator, const Matrix& W0, const std::vector<double>& sizes) {
  return stepped(integrator, W0, sizes, [](Integrator&, int) {});
}

// Runs of so many steps each, of one size, each from the W that the one before it has left.
Seen in_parts(Integrator& integrator, const Matrix& W0, double h, const std::vector<long>& parts) {
  Seen seen = {{}, W0};
  for (const long steps : parts) {
    run(integrator, seen.W, h, steps, [&](long, const Matrix&, const StepReport& report) {
      seen.reports.push_back(text(report));
    });
  }
  return seen;
}

constexpr double h = 0.1;
const std::vector<double> twenty(20, h);

// By n and method: at n = 9 both forms of each method, at n = 49 the fast forms, which cut bands.
class EachRun : public ::testing::TestWithParam<std::tuple<Index, IntegratorEntry>> {
 protected:
  // Calls test(make, W₀) for both forms of the method, with and without bands and with a trace.
  template <class Test>
  static void for_each_form(const Test& test) {
    const auto& [n, method] = GetParam();
    for (const IntegratorEntry& entry : forms_of(method)) {
      if (n == 9 || entry.is_fast) {
        const Scene scene = smooth_scene(n);
        for (const double c : n == 9 ? std::vector<double>{0.0, 100.0} : std::vector<double>{0.0}) {
          SCOPED_TRACE(fmt::format("{} n = {} c = {}", entry.name, n, c));
          Matrix W0 = scene.initial;
          W0.diagonal().array() += Complex(0.0, c);
          test([&] { return made(entry, *scene.flow); }, W0);
        }
      }
    }
  }
};

TEST_P(EachRun, InPartsIsTheRunInOneGo) {
  for_each_form([](const auto& make, const Matrix& W0) {
    const Seen whole = stepped(*make(), W0, twenty);
    expect_same(in_parts(*make(), W0, h, {20}), whole, "observed");
    expect_same(in_parts(*make(), W0, h, {10, 10}), whole, "10 + 10");
    expect_same(in_parts(*make(), W0, h, std::vector<long>(20, 1)), whole, "20 single steps");
    const auto set_again = [](Integrator& integrator, int) {
      integrator.set_state(integrator.state());
    };
    expect_same(stepped(*make(), W0, twenty, set_again), whole, "set again");
    const auto amend_nothing = [](Integrator& integrator, int) {
      integrator.amend_state(integrator.state());
    };
    expect_same(stepped(*make(), W0, twenty, amend_nothing), whole, "amended by nothing");
  });
}

TEST_P(EachRun, InPartsIsTheRunInOneGoWithStepsOfSeveralSizes) {
  const std::vector<double> sizes = {h, h, h, h, 0.5 * h, 0.5 * h, 0.0, 0.5 * h, -h, h, h};
  for_each_form([&](const auto& make, const Matrix& W0) {
    const Seen whole = stepped(*make(), W0, sizes);
    const auto set_again = [](Integrator& integrator, int) {
      integrator.set_state(integrator.state());
    };
    expect_same(stepped(*make(), W0, sizes, set_again), whole, "set again");
  });
}

// Another matrix begins a new run, if only one bit is another: so the tests above see something.
TEST(ARun, InPartsIsAnotherWhereItsStateWasChangedByOneBit) {
  const Scene scene = smooth_scene(17);
  for (const char* method : {"group2", "group2_frame", "elp4_frame"}) {
    const auto make = [&] { return made(fast_entry(method), *scene.flow); };
    const auto change = [](Integrator& integrator, int) {
      Matrix W = integrator.state();
      W(0, 0).imag(std::nextafter(W(0, 0).imag(), 1.0));
      integrator.set_state(W);
    };
    EXPECT_NE(stepped(*make(), scene.initial, twenty, change).reports,
              stepped(*make(), scene.initial, twenty).reports)
        << method;
  }
}

// What a lone step may be: of another state, norm and size, of no size, and one that fails.
struct Lone {
  const char* what;
  double norm;
  double h;
  Status status = Status::converged;
};
const std::vector<Lone> lone_steps = {
    {"of another state", 1.0, h},   {"of another size", 1.0, 0.17},
    {"of another norm", 1e6, 2e-7}, {"of a smaller norm", 1e-5, 2e4},
    {"of size 0", 1.0, 0.0},        {"that fails", 1.0, 1e200, Status::diverged}};

TEST_P(EachRun, IsNotDisturbedByLoneStepsInItsCourse) {
  for_each_form([](const auto& make, const Matrix& W0) {
    const Seen whole = stepped(*make(), W0, twenty);
    const Matrix other = rough_scene(W0.rows()).initial;
    for (const Lone& lone : lone_steps) {
      const auto step_alone = [&](Integrator& integrator, int k) {
        if (k != 1 && k != 2 && k != 3 && k != 12) return;
        Matrix W = lone.norm * other, expected = W;
        const StepReport report = integrator.step(W, lone.h);
        EXPECT_EQ(report.status == Status::converged, lone.status == Status::converged);
        EXPECT_EQ(text(report), text(make()->step(expected, lone.h))) << lone.what;
        EXPECT_TRUE(W == expected) << lone.what;
      };
      expect_same(stepped(*make(), W0, twenty, step_alone), whole, lone.what);
    }
  });
}

// What a run is told of itself is that of its own last step.
TEST_P(EachRun, KnowsItsLastStepAfterALoneOne) {
  for_each_form([](const auto& make, const Matrix& W0) {
    const auto integrator = make();
    auto* fast = dynamic_cast<FastIntegrator*>(integrator.get());
    integrator->set_state(W0);
    for (int k = 0; k < 5; ++k) {
      ASSERT_EQ(integrator->step(h).status, Status::converged);
      const auto change = [&] { return fast != nullptr ? fast->change_of_one_more_sweep() : 0.0; };
      const double last_change = change();
      const double energy = integrator->energy();
      Matrix W = rough_scene(W0.rows()).initial;
      ASSERT_EQ(integrator->step(W, 0.17).status, Status::converged);
      EXPECT_EQ(change(), last_change);
      integrator->set_state(integrator->state());
      EXPECT_EQ(change(), last_change);
      EXPECT_EQ(integrator->energy(), energy);
    }
  });
}

// To ask how strictly a step was accepted disturbs no later one.
TEST_P(EachRun, IsNotDisturbedByAskingForOneMoreSweep) {
  for_each_form([](const auto& make, const Matrix& W0) {
    const auto integrator = make();
    auto* fast = dynamic_cast<FastIntegrator*>(integrator.get());
    if (fast == nullptr) return;
    const auto ask = [&](Integrator&, int) { EXPECT_GE(fast->change_of_one_more_sweep(), 0.0); };
    expect_same(stepped(*integrator, W0, twenty, ask), stepped(*make(), W0, twenty), "asked");
  });
}

// Steps of another size are those of a new run from the state that they begin with.  The control:
// steps of the same size go on.
TEST(ARun, BeginsAnewWhereTheStepSizeChanges) {
  const Scene scene = smooth_scene(17);
  constexpr double fine = 0.02;
  const std::vector<double> first(20, fine);
  for (const char* method : {"group2", "algebra1", "yoshida4", "elp2", "elp4", "elp6"}) {
    for (const double next : {0.9 * fine, fine}) {
      const std::vector<double> sizes(6, next);
      const auto goes_on = made(fast_entry(method), *scene.flow);
      const Matrix W = stepped(*goes_on, scene.initial, first).W;
      Seen seen;
      for (const double size : sizes) advance(*goes_on, size, seen);
      seen.W = goes_on->state();
      const Seen begun = stepped(*made(fast_entry(method), *scene.flow), W, sizes);
      if (next == fine) {
        EXPECT_NE(seen.reports, begun.reports) << method;
      } else {
        expect_same(seen, begun, method);
      }
    }
  }
}

// All that a step leaves to the next one is in its memory.  The control: steps of another state
// with the same memory are seen in the run.
TEST(ASubstep, LeavesNothingToTheNextOneBesideItsMemory) {
  constexpr Index n = 17;
  constexpr double long_step = 0.5;  // in short ones the error of an explicit start is rounding
  const Scene scene = smooth_scene(n);
  const SplitMatrix other(rough_scene(n).initial);
  const FastOptions options = {.iteration = {.tolerance = 1e-8}};
  const std::vector<std::function<std::unique_ptr<StageSystem>()>> systems = {
      [&] { return std::make_unique<ExponentialSystem>(*scene.flow, 4, options); },
      [&] { return std::make_unique<ExponentialSystem>(*scene.flow, 6, options); },
      [&] { return std::make_unique<MidpointSystem>(*scene.flow, 1, false); }};
  enum class Others { none, with_their_own_memory, with_that_of_the_run };
  for (const auto& make_system : systems) {
    const auto seen_with = [&](Others others) {
      FastSubstep substep(make_system(), options);
      SubstepMemory memory = substep.memory_of_run(), beside = substep.memory_beside();
      SplitMatrix W(scene.initial), W1(n), ignored(n);
      Seen seen;
      for (int k = 0; k < 8; ++k) {
        beside.forget();
        if (others != Others::none) {
          const bool is_shared = others == Others::with_that_of_the_run;
          substep.advance(ignored, other, long_step, is_shared ? memory : beside);
        }
        seen.reports.push_back(text(substep.advance(W1, W, long_step, memory)));
        std::swap(W, W1);
      }
      seen.W = W.interleaved();
      return seen;
    };
    const Seen alone = seen_with(Others::none);
    expect_same(seen_with(Others::with_their_own_memory), alone, "with others beside it");
    EXPECT_NE(seen_with(Others::with_that_of_the_run).reports, alone.reports);
  }
}

// A step of size 0 of another state is that of a new integrator, and so are those after it.
TEST_P(EachRun, OfStepsOfSize0IsThatOfANewIntegrator) {
  for_each_form([](const auto& make, const Matrix& W0) {
    const std::vector<double> sizes = {0.0, 0.0, h, 0.0, h, h};
    const auto used = make();
    stepped(*used, rough_scene(W0.rows()).initial, {h, h, h, 0.0, 0.0});
    expect_same(stepped(*used, W0, sizes), stepped(*make(), W0, sizes), "after another run");

    const Seen unmoved = stepped(*make(), W0, {0.0, 0.0, 0.0});
    EXPECT_LE(largest_difference(unmoved.W, W0), 1e-14 * W0.norm());  // by a projection at most
    Matrix W = W0;
    EXPECT_EQ(make()->step(W, 0.0).status, Status::converged);
    EXPECT_LE(largest_difference(W, W0), 1e-14 * W0.norm());
  });
}

INSTANTIATE_TEST_SUITE_P(Small, EachRun,
                         ::testing::Combine(::testing::Values(9),
                                            ::testing::ValuesIn(integrators())),
                         name_of_method);
INSTANTIATE_TEST_SUITE_P(Large, EachRun,
                         ::testing::Combine(::testing::Values(49),
                                            ::testing::ValuesIn(fast_integrators())),
                         name_of_method);

}  // namespace
}  // namespace isosyrk::testing
