// Start values against unknowns of which the next is known.
#include "isosyrk/solver/predictor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {
namespace {

constexpr double h = 0.1;
constexpr Index n = 9;

// X(t) for each unknown of two kinds, one of a kind with two.
template <class Entry>
Unknowns unknowns_at(double t, const Entry& entry) {
  Unknowns unknowns;
  for (const std::size_t count : {1, 2}) {
    auto& kind = unknowns.emplace_back();
    for (std::size_t item = 0; item < count; ++item) {
      Matrix X(n, n);
      for (Index r = 0; r < n; ++r) {
        for (Index c = 0; c < n; ++c) {
          const auto phase = static_cast<double>(3 * r + c * c + static_cast<Index>(item));
          X(r, c) = {entry(t, phase), entry(t, 2.0 * phase + 1.0)};
        }
      }
      kind.emplace_back(X);
    }
  }
  return unknowns;
}

double oscillation(double t, double phase) {
  return std::cos(9.0 * t + phase) + 0.5 * std::sin(5.0 * t + phase * phase);
}

double polynomial(double t, double phase) { return phase * t * t * t - t * t + phase; }

// The largest miss of the value after `steps` steps.
template <class Entry>
double miss(StartValues& values, int steps, const Entry& entry) {
  const auto time = [](int step) { return h * static_cast<double>(step); };
  for (int step = 0; step < steps; ++step) {
    const Unknowns solved = unknowns_at(time(step), entry);
    values.accept(h);
    for (std::size_t kind = 0; kind < solved.size(); ++kind) {
      for (std::size_t i = 0; i < solved[kind].size(); ++i) {
        values.keep(kind, i, solved[kind][i], {});
      }
    }
    values.learn();
  }
  EXPECT_TRUE(values.begin(h));
  const Unknowns expected = unknowns_at(time(steps), entry);
  double largest = 0.0;
  for (std::size_t kind = 0; kind < expected.size(); ++kind) {
    for (std::size_t i = 0; i < expected[kind].size(); ++i) {
      PlanarMatrix X(n);
      values.predict(kind, i, X, {});
      largest = std::max(largest, (X.entries() - expected[kind][i].entries()).norm());
    }
  }
  return largest;
}

template <class Entry>
double miss(int order, bool fitted, int steps, const Entry& entry) {
  StartValues values(order, fitted, unknowns_at(0.0, entry));
  return miss(values, steps, entry);
}

TEST(StartValues, AreThoseOfThePolynomialThroughFewSteps) {
  for (const bool fitted : {false, true}) {
    for (const int steps : {4, 5, 8}) {
      EXPECT_LT(miss(16, fitted, steps, polynomial), 1e-10) << steps;
    }
    EXPECT_GT(miss(16, fitted, 3, polynomial), 1e-3);  // of order 4
    EXPECT_GT(miss(3, fitted, 8, polynomial), 1e-3);
    EXPECT_LT(miss(4, fitted, 8, polynomial), 1e-10);
  }
}

TEST(StartValues, FittedMeetAnOscillationThatThePolynomialMisses) {
  for (const int steps : {16, 17, 18, 40}) {
    EXPECT_LT(miss(16, true, steps, oscillation), 1e-6) << steps;
    EXPECT_GT(miss(16, false, steps, oscillation), 1e-3) << steps;
  }
}

TEST(StartValues, ASumOfOscillationsNeedsTwiceAsManyTerms) {
  EXPECT_LT(miss(10, true, 20, oscillation), 1e-6);  // four terms beyond the six differences
  EXPECT_GT(miss(9, true, 20, oscillation), 1e-4);
}

TEST(StartValues, ArePredictedInHalvesAsInTheWhole) {
  const Unknowns none = unknowns_at(0.0, oscillation);
  StartValues values(16, true, none);
  miss(values, 20, oscillation);
  PlanarMatrix whole(n), halves(n);
  values.predict(1, 1, whole, {});
  for (const std::ptrdiff_t part : {0, 1}) values.predict(1, 1, halves, {part, 2});
  EXPECT_EQ(halves.entries(), whole.entries());
}

TEST(StartValues, StartColdAtFirstAtAnotherStepAfterForgettingAndAtOrderZero) {
  StartValues values(16, true, unknowns_at(0.0, polynomial));
  EXPECT_FALSE(values.begin(h));
  EXPECT_LT(miss(values, 12, polynomial), 1e-10);
  EXPECT_FALSE(values.begin(0.5 * h));
  values.accept(0.5 * h);
  EXPECT_FALSE(values.begin(h));
  values.forget();
  EXPECT_FALSE(values.begin(0.5 * h));
  // And then by what came since alone.
  EXPECT_GT(miss(values, 3, polynomial), 1e-3);

  StartValues cold(0, true, unknowns_at(0.0, polynomial));
  cold.accept(h);
  cold.learn();
  EXPECT_FALSE(cold.begin(h));
}

TEST(StartValues, RefuseAnOrderTheyHaveNoRoomFor) {
  for (const int order : {-1, 25}) {
    EXPECT_THROW(StartValues(order, true, unknowns_at(0.0, polynomial)), std::invalid_argument);
  }
}

}  // namespace
}  // namespace isosyrk
