// Predictions of unknowns of which the next value is known.
#include "isosyrk/solver/predictor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace isosyrk {
namespace {

constexpr double h = 0.1;
constexpr Index n = 9;

// X(t) for each unknown of two kinds, one of a kind with two.
template <class Entry>
Unknowns unknowns_at(double t, const Entry& entry) {
  const auto matrix = [&](Index item) {
    return SplitMatrix(Matrix::NullaryExpr(n, n, [&](Index r, Index c) {
      const auto phase = static_cast<double>(3 * r + c * c + item);
      return Complex(entry(t, phase), entry(t, 2.0 * phase + 1.0));
    }));
  };
  return {{matrix(0)}, {matrix(0), matrix(1)}};
}

double oscillations(double t, double phase) {
  return std::cos(9.0 * t + phase) + 0.5 * std::sin(5.0 * t + phase * phase);
}

// The largest difference of an unknown in the Frobenius norm.
double difference(const Unknowns& x, const Unknowns& y) {
  double largest = 0.0;
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    for (std::size_t i = 0; i < x[kind].size(); ++i) {
      largest = std::max(largest, (x[kind][i].entries() - y[kind][i].entries()).norm());
    }
  }
  return largest;
}

// The largest miss of the value after `steps` steps.
template <class Entry>
double miss(Predictor& predictor, int steps, const Entry& entry) {
  const auto time = [](int step) { return h * static_cast<double>(step); };
  for (int step = 0; step < steps; ++step) predictor.accept(h, unknowns_at(time(step), entry));
  Unknowns x = unknowns_at(0.0, entry);
  EXPECT_TRUE(predictor.predict(h, x));
  return difference(x, unknowns_at(time(steps), entry));
}

template <class Entry>
double miss(int past_steps, int steps, const Entry& entry) {
  Predictor predictor(past_steps, unknowns_at(0.0, entry));
  return miss(predictor, steps, entry);
}

// x(t) = Σ_d (t - 1/2)^d cos(phase d) up to a degree.
auto polynomial_of(int degree) {
  return [degree](double t, double phase) {
    double sum = 0.0;
    for (int d = 0; d <= degree; ++d) sum += std::pow(t - 0.5, d) * std::cos(phase * d);
    return sum;
  };
}
const auto cubic = polynomial_of(3);

// Weights of the polynomial through K values are binomials, 2^K in all; so much is made of the
// rounding of the values, K roundoffs each (K terms of size K at most), in n² complex entries.
TEST(Predictor, IsExactOnPolynomialsOfADegreeBelowTheNumberOfPastSteps) {
  for (int K = 1; K <= 7; ++K) {
    const double bound = std::pow(2.0, K) * K * K * std::numeric_limits<double>::epsilon() *
                         std::sqrt(2.0) * static_cast<double>(n);
    for (int degree = 0; degree < K; ++degree) {
      EXPECT_LE(miss(K, 12, polynomial_of(degree)), bound) << K << " " << degree;
      EXPECT_LE(miss(16, K, polynomial_of(degree)), bound) << K << " " << degree;
    }
    // What is missed of the term of degree K is ∇^K t^K = K! h^K.
    EXPECT_GT(miss(K, 12, polynomial_of(K)), 1e3 * bound) << K;
    EXPECT_GT(miss(16, K, polynomial_of(K)), 1e3 * bound) << K;
  }
}

// Sixth differences are 0 here but for 2⁶ roundoffs of |x| < 6 n √2, 1e-12.  Weights fitted to such
// noise are at most 1 each, since larger ones would enlarge the residual: 18 of them make 2e-11.
TEST(Predictor, IsExactOnPolynomialsOfADegreeBelowSixWhenItFits) {
  for (const int past_steps : {8, 12, 16, 24}) {
    for (int degree = 0; degree < 6; ++degree) {
      EXPECT_LE(miss(past_steps, 30, polynomial_of(degree)), 1e-10) << past_steps << " " << degree;
    }
  }
}

// The normal equations carry half the digits: with a diagonal raised by 1e-15 of its mean, weights
// c that would be exact leave sqrt(1e-15) |c| of the differences.  Here |c| < 7, and the sixth
// differences of 3 matrices of n² entries come to (2 sin(ωh/2))^6 |x| < 25: 6e-6 of an oscillation.
// Growth and decay by e^(h/2) a step have differences of (h/2)^6, with nothing left of these.
TEST(Predictor, IsExactOnAFewExponentialsOnceItFitsAndThePolynomialIsNot) {
  const auto exponentials = [](double t, double phase) {
    return std::exp(0.5 * t + std::sin(phase)) + std::cos(phase) * std::exp(-3.0 * t);
  };
  const auto damped = [](double t, double phase) {
    return std::exp(-0.5 * t) * std::cos(6.0 * t + phase);
  };
  const auto fast = [](double t, double phase) { return std::cos(10.0 * t + phase); };
  for (const int steps : {10, 16, 30}) {
    EXPECT_LT(miss(16, steps, exponentials), 6e-6) << steps;
    EXPECT_LT(miss(16, steps, damped), 6e-6) << steps;
    EXPECT_LT(miss(16, steps, fast), 6e-6) << steps;
    EXPECT_GT(miss(7, steps, damped), 6e-5) << steps;
    EXPECT_GT(miss(7, steps, fast), 1e-2) << steps;
    EXPECT_GT(miss(7, steps, oscillations), 1e-3) << steps;
  }
  for (const int steps : {16, 17, 18, 40}) EXPECT_LT(miss(16, steps, oscillations), 1e-6) << steps;
  EXPECT_LT(miss(10, 20, oscillations), 1e-6);  // four terms beyond the six differences
  EXPECT_GT(miss(9, 20, oscillations), 1e-4);
}

TEST(Predictor, StartsColdAtFirstAtAnotherStepAfterForgettingAndWithNoPastSteps) {
  const Unknowns start = unknowns_at(0.3, cubic);
  Unknowns x = start;
  Predictor predictor(16, start);
  const auto expect_cold = [&](Predictor& tried, double step, const char* why) {
    EXPECT_FALSE(tried.predict(step, x)) << why;
    EXPECT_EQ(difference(x, start), 0.0) << why << ": x is as it was";
  };
  expect_cold(predictor, h, "the first step");
  EXPECT_LT(miss(predictor, 12, cubic), 1e-10);
  expect_cold(predictor, 0.5 * h, "another step size");
  expect_cold(predictor, -h, "backwards");
  predictor.accept(0.5 * h, unknowns_at(0.0, cubic));
  expect_cold(predictor, h, "the step size of before");
  Unknowns last = start;
  EXPECT_TRUE(predictor.predict(0.5 * h, last));
  EXPECT_EQ(difference(last, unknowns_at(0.0, cubic)), 0.0);  // all that there is
  predictor.forget();
  expect_cold(predictor, 0.5 * h, "after forgetting");
  // And then as a new one, by what came since alone: 8 steps, too few to fit weights to.
  EXPECT_EQ(miss(predictor, 8, oscillations), miss(16, 8, oscillations));

  Predictor cold(0, start);
  for (int step = 0; step < 3; ++step) cold.accept(h, start);
  expect_cold(cold, h, "no past steps");
}

TEST(Predictor, RefusesMorePastStepsThanItHasRoomFor) {
  for (const int past_steps : {-1, 25}) {
    EXPECT_THROW(Predictor(past_steps, unknowns_at(0.0, cubic)), std::invalid_argument);
  }
  EXPECT_NO_THROW(Predictor(24, unknowns_at(0.0, cubic)));
}

}  // namespace
}  // namespace isosyrk
