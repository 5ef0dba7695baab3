// A run that is written to an archive between two steps, and goes on in a new integrator.
#include "isosyrk/linalg/state_archive.h"

#include <sstream>

#include "isosyrk/catalogue/fast_forms.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr int steps_before = 12;  // more than any multistep method has past steps
constexpr int steps_after = 5;

// What a step shows.
void expect_same_step(const StepReport& report, const StepReport& expected) {
  EXPECT_EQ(report.status, expected.status);
  EXPECT_EQ(report.attempt, expected.attempt);
  EXPECT_EQ(report.sweeps, expected.sweeps);
  EXPECT_EQ(report.last_change, expected.last_change);
  EXPECT_EQ(report.contraction, expected.contraction);
  EXPECT_EQ(report.work.equivalent_products, expected.work.equivalent_products);
  EXPECT_EQ(report.work.projections, expected.work.projections);
}

std::string written(Integrator& integrator) {
  std::ostringstream to;
  StateWriter writer(to);
  integrator.archive(writer);
  return std::move(to).str();
}

void read(Integrator& integrator, const std::string& bytes) {
  std::istringstream from(bytes);
  StateReader reader(from);
  integrator.archive(reader);
  EXPECT_EQ(from.peek(), EOF) << "all of it is read";
}

// Every listed method in both its forms.
std::vector<IntegratorEntry> both_forms() {
  std::vector<IntegratorEntry> all;
  for (const IntegratorEntry& entry : integrators()) {
    for (const IntegratorEntry& form : forms_of(entry)) all.push_back(form);
  }
  return all;
}

// A run of a method: its scene, its step, and how accurate it is.
struct Case {
  Scene scene;
  double h;
  IterationOptions iteration = {};
  bool bands = false;  // cut at any n, in a fast form
};

class ArchivedRun : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  std::unique_ptr<Integrator> made(const Case& of) const {
    const IntegratorEntry& entry = GetParam();
    if (entry.is_fast && of.bands) {
      FastOptions options{.iteration = of.iteration, .bands = true};
      return entry.make_fast(of.scene.flow, options);
    }
    return entry.make(of.scene.flow, of.iteration, ProductBackend::openblas);
  }
  std::unique_ptr<Integrator> begun(const Case& of, int steps) const {
    auto integrator = made(of);
    integrator->set_state(of.scene.initial);
    for (int k = 0; k < steps; ++k) {
      EXPECT_EQ(integrator->step(of.h).status, Status::converged);
    }
    return integrator;
  }
  void expect_goes_on(const Case& of, int steps) const {
    const auto whole = begun(of, steps);
    const auto first = begun(of, steps);
    const auto second = made(of);
    read(*second, written(*first));
    for (int k = 0; k < steps_after; ++k) {
      expect_same_step(second->step(of.h), whole->step(of.h));
      EXPECT_TRUE(second->state() == whole->state());
    }
    EXPECT_EQ(written(*second), written(*whole));
  }
};

TEST_P(ArchivedRun, GoesOnBitForBit) {
  for (const int steps : {0, 1, steps_before}) {
    SCOPED_TRACE(steps);
    expect_goes_on({smooth_scene(9), 0.1}, steps);
  }
  expect_goes_on({rough_scene(17), 0.15, {.tolerance = 1e-8}}, steps_before);
}

// Where bands are cut, and where a trace is set aside; and in a step that is not the usual one.
TEST_P(ArchivedRun, GoesOnInBandsWithATraceAndAfterAChangeOfStep) {
  Case of{smooth_scene(17), 0.1, {.tolerance = 1e-10}, true};
  of.scene.initial.diagonal().array() += Complex(0.0, 3.0);
  expect_goes_on(of, 2);
  const auto whole = begun(of, 3);
  whole->step(0.07);
  const auto second = made(of);
  read(*second, written(*whole));
  EXPECT_TRUE(second->state() == whole->state());
  expect_same_step(second->step(0.07), whole->step(0.07));
  EXPECT_TRUE(second->state() == whole->state());
}

// Control: from the state alone a run goes on otherwise wherever a method keeps anything else.
TEST_P(ArchivedRun, IsAnotherFromItsStateAlone) {
  const IntegratorEntry& entry = GetParam();
  const bool remembers = entry.co_rotating || entry.projected ||
                         entry.family == Family::adams_bashforth_moulton ||
                         (entry.is_fast && !entry.is_explicit);
  if (!remembers) return;
  const Case of{smooth_scene(9), 0.1, {.tolerance = 1e-10}};
  const auto whole = begun(of, steps_before);
  const auto second = made(of);
  second->set_state(whole->state());
  bool differs = false;
  for (int k = 0; k < steps_after; ++k) {
    differs |= second->step(of.h).work.products != whole->step(of.h).work.products;
    differs |= !(second->state() == whole->state());
  }
  EXPECT_TRUE(differs);
}

INSTANTIATE_TEST_SUITE_P(EveryIntegrator, ArchivedRun, ::testing::ValuesIn(both_forms()),
                         ::testing::PrintToStringParamName());

TEST(ArchivedRun, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = rough_scene(97);  // two threads from n = 96 on
  const auto made = [&](int threads) {
    return integrator_entry("elp4_frame", Solver::fast, with_defaults({.threads = threads}, 97))
        .make(scene.flow, {.tolerance = 1e-8}, ProductBackend::openblas);
  };
  const auto one = made(1), two = made(2);
  one->set_state(scene.initial);
  for (int k = 0; k < 3; ++k) one->step(0.1);
  read(*two, written(*one));
  for (int k = 0; k < 3; ++k) expect_same_step(two->step(0.1), one->step(0.1));
  EXPECT_TRUE(two->state() == one->state());
}

TEST(ArchivedRun, IsThatOfRealAndOfBlockDiagonalMatrices) {
  for (const SceneCase& tested : tested_scenes()) {
    const Scene scene = scene_by_name(tested.name, tested.parameters);
    for (const char* name : {"group2", "rk4", "abm8"}) {
      const IntegratorEntry& entry = integrator_entry(name);
      if (!takes(entry, *scene.flow)) continue;
      const auto make = [&] { return entry.make(scene.flow, {}, ProductBackend::openblas); };
      const auto whole = make(), second = make();
      whole->set_state(scene.initial);
      for (int k = 0; k < steps_before; ++k) whole->step(0.05);
      read(*second, written(*whole));
      for (int k = 0; k < steps_after; ++k) expect_same_step(second->step(0.05), whole->step(0.05));
      EXPECT_TRUE(second->state() == whole->state()) << tested.name << " " << name;
    }
  }
}

TEST(ArchivedRun, OfAnotherSizeMethodOrLengthIsRefused) {
  const auto bytes_of = [](const char* name, Index n) {
    const Scene scene = smooth_scene(n);
    const auto integrator = integrator_entry(name, Solver::fast, with_defaults({}, n))
                                .make(scene.flow, {}, ProductBackend::openblas);
    integrator->set_state(scene.initial);
    for (int k = 0; k < steps_before; ++k) integrator->step(0.1);
    return written(*integrator);
  };
  const Scene scene = smooth_scene(9);
  const auto integrator = integrator_entry("group2", Solver::fast, with_defaults({}, 9))
                              .make(scene.flow, {}, ProductBackend::openblas);
  const std::string good = bytes_of("group2", 9);
  expect_refused([&] { read(*integrator, bytes_of("group2", 17)); }, "of another size");
  expect_refused([&] { read(*integrator, bytes_of("group3", 9)); }, "of another size");
  expect_refused([&] { read(*integrator, good.substr(0, good.size() - 1)); }, "ends too early");
  expect_refused([&] { read(*integrator, ""); }, "ends too early");
  read(*integrator, good);
  EXPECT_EQ(written(*integrator), good);
}

TEST(StateWriter, SaysThatAStreamTakesNoMore) {
  std::ostringstream to;
  to.setstate(std::ios::badbit);
  StateWriter writer(to);
  double number = 1.0;
  EXPECT_THROW(writer.pass(number), std::ios_base::failure);
}

}  // namespace
}  // namespace isosyrk::testing
