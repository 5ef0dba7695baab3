// What comes next in a sequence of vectors, against sequences of which that is known.
#include "isosyrk/solver/linear_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {
namespace {

constexpr Index numbers = 48;

// Two oscillations of each number, in phases and sizes of its own: every y is a sum of the last
// four.
RealVector oscillations(int m) {
  RealVector y(numbers);
  for (Index i = 0; i < numbers; ++i) {
    const auto phase = static_cast<double>(i * i);
    y(i) = std::cos(0.9 * m + phase) + 0.3 * std::sin(0.4 * m + 2.0 * phase);
  }
  return y;
}

void add(LinearPrediction& prediction, const RealVector& y) {
  prediction.next() = y;
  prediction.add();
}

// What a prediction of y_{m+1} by the last q misses.
double miss(int q, int m) {
  LinearPrediction prediction(numbers, q);
  for (int k = 0; k <= m; ++k) add(prediction, oscillations(k));
  const LinearPrediction::Weights c = prediction.weights();
  EXPECT_EQ(c.size(), q);
  RealVector predicted = RealVector::Zero(numbers);
  for (Index j = 0; j < c.size(); ++j) predicted += c(j) * oscillations(m - static_cast<int>(j));
  return (predicted - oscillations(m + 1)).norm();
}

// More terms than a sequence takes make the normal equations singular.
TEST(LinearPrediction, IsExactForAsManyTermsAsASequenceTakesAndNoWorseForMore) {
  for (const int m : {4, 9, 30}) EXPECT_LT(miss(4, m), 1e-11) << m;
  EXPECT_GT(miss(3, 9), 1e-2);
  for (const int q : {6, 12}) EXPECT_LT(miss(q, 30), 1e-6) << q;
}

TEST(LinearPrediction, HasOneTermLessThanVectorsAndNoneOfWhatWasForgotten) {
  LinearPrediction fresh(numbers, 3), tried(numbers, 3);
  for (int m = 0; m < 7; ++m) add(tried, oscillations(m).cwiseAbs2());
  tried.forget();
  EXPECT_EQ(tried.terms(), 0);
  for (const int terms : {0, 1, 2, 3, 3}) {
    add(fresh, oscillations(terms));
    add(tried, oscillations(terms));
    EXPECT_EQ(tried.terms(), terms);
    EXPECT_EQ(tried.weights().size(), terms);
    EXPECT_EQ(tried.weights(), fresh.weights());
  }
}

TEST(LinearPrediction, HasNoWeightsWhereTheyCannotBeTold) {
  for (const double value : {0.0, std::nan(""), 1e300}) {
    LinearPrediction prediction(numbers, 2);
    for (int m = 0; m < 3; ++m) add(prediction, RealVector::Constant(numbers, value));
    EXPECT_EQ(prediction.weights().size(), 0) << value;
  }
}

TEST(LinearPrediction, RefusesNumbersOfTermsItHasNoRoomFor) {
  for (const int q : {-1, 25}) EXPECT_THROW(LinearPrediction(numbers, q), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk
