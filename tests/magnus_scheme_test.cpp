// The data of the explicit Magnus methods: their moments and their exponents.
#include <fmt/format.h>

#include <cmath>

#include "isosyrk/integrators/magnus_exponent.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "isosyrk/tableaux/magnus_schemes.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachMagnusScheme : public ::testing::TestWithParam<const MagnusScheme* (*)()> {
 protected:
  const MagnusScheme& scheme = *GetParam()();
};
INSTANTIATE_TEST_SUITE_P(Schemes, EachMagnusScheme,
                         ::testing::Values([] { return &magnus4(); }, [] { return &magnus5(); }),
                         [](const auto& tested) { return tested.param()->name; });

using Numbers = std::vector<double*>;

void append(Numbers& numbers, MagnusScheme::Sum& sum) {
  for (auto& term : sum) numbers.insert(numbers.end(), {&term.above, &term.below});
}

Numbers numbers_of_moments(MagnusScheme& scheme) {
  Numbers numbers;
  for (auto& moment : scheme.moments) {
    numbers.push_back(&moment.over);
    append(numbers, moment.of_B);
    append(numbers, moment.of_D);
  }
  return numbers;
}

Numbers numbers_of_exponent(MagnusScheme& scheme) {
  Numbers numbers;
  for (auto& sum : scheme.sums) append(numbers, sum);
  for (auto& bracket : scheme.brackets) {
    append(numbers, bracket.left);
    append(numbers, bracket.right);
    numbers.push_back(&bracket.scale);
  }
  append(numbers, scheme.Omega);
  return numbers;
}

// ∫₀¹ (τ - ½)^k τ^p dτ, by a quadrature that is exact for degrees up to 11.
double moment_of_power(std::size_t k, std::size_t p) {
  static const Tableau gauss = gauss_tableau(6);
  double sum = 0.0;
  for (Index i = 0; i < gauss.b.size(); ++i) {
    const double c = gauss.c(i);
    sum += gauss.b(i) * std::pow(c - 0.5, static_cast<double>(k)) *
           std::pow(c, static_cast<double>(p));
  }
  return sum;
}

// Returns the value at c, and the slope there, of t^p.
double power(double c, std::size_t p) { return std::pow(c, static_cast<double>(p)); }
double slope_of_power(double c, std::size_t p) {
  return p == 0 ? 0.0 : static_cast<double>(p) * power(c, p - 1);
}

// Returns the largest error of a moment of 1, t, ... t^(2s-1), for s nodes and h = 1.
double error_of_moments(const MagnusScheme& scheme) {
  const auto node = [&](std::size_t i) { return scheme.nodes(static_cast<Index>(i)); };
  double largest = 0.0;
  for (std::size_t k = 0; k < scheme.moments.size(); ++k) {
    const MagnusScheme::Moment& moment = scheme.moments[k];
    for (std::size_t p = 0; p < 2 * static_cast<std::size_t>(scheme.nodes.size()); ++p) {
      double sum = 0.0;
      for (const auto& term : moment.of_B) sum += term.above / term.below * power(node(term.of), p);
      for (const auto& term : moment.of_D) {
        sum += term.above / term.below * slope_of_power(node(term.of), p);
      }
      largest = std::max(largest, std::abs(sum / moment.over - moment_of_power(k, p)));
    }
  }
  return largest;
}

TEST_P(EachMagnusScheme, HasTheMomentsOfThePolynomialThroughItsValues) {
  EXPECT_LE(error_of_moments(scheme), 1e-15);
  MagnusScheme changed = scheme;
  for (double* number : numbers_of_moments(changed)) {
    const double before = *number;
    *number *= 1.01;
    EXPECT_GE(error_of_moments(changed), 1e-6) << before;
    *number = before;
  }
}

// Y' = B(t) Y, Y(0) = 1, with B(t) = Σ_j b_j t^j.
class LinearEquation {
 public:
  LinearEquation() {
    for (unsigned seed = 1; seed <= 6; ++seed) b_.push_back(random_skew_hermitian(3, seed));
  }

  // Returns Y(h) = Σ_k Y_k h^k, where (k + 1) Y_{k+1} = Σ_j b_j Y_{k-j}.
  Matrix solution(double h) const {
    std::vector<Matrix> Y = {Matrix::Identity(3, 3)};
    Matrix sum = Y[0];
    for (std::size_t k = 0; k < 40; ++k) {
      Matrix next = Matrix::Zero(3, 3);
      for (std::size_t j = 0; j < b_.size() && j <= k; ++j) next += product({b_[j], Y[k - j]});
      Y.push_back(next / static_cast<double>(k + 1));
      sum += power(h, k + 1) * Y.back();
    }
    return sum;
  }
  // Returns h ∫₀¹ (τ - ½)^k B(τh) dτ for the first k.
  std::vector<Matrix> moments(std::size_t count, double h) const {
    std::vector<Matrix> m(count, Matrix::Zero(3, 3));
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < b_.size(); ++j) {
        m[k] += power(h, j + 1) * moment_of_power(k, j) * b_[j];
      }
    }
    return m;
  }

 private:
  std::vector<Matrix> b_;
};

// Returns the order of e^Ω for exact moments, from the errors of two steps.
double order_of_exponent(const MagnusScheme& scheme) {
  const QuadraticAlgebra algebra = QuadraticAlgebra::skew_hermitian(3);
  AdjointRotation<Complex> rotation(algebra);
  Products products(ProductBackend::openblas, 3);
  PublishedLie<Complex> lie(algebra, rotation, products, {});
  ExponentOfMoments<PublishedLie<Complex>> exponent(lie, scheme);
  const LinearEquation equation;
  const auto error = [&](double h) {
    Matrix Omega = lie.zero();
    exponent.form(Omega, equation.moments(scheme.moments.size(), h));
    return (exponential(Omega) - equation.solution(h)).norm();
  };
  return std::log2(error(0.1) / error(0.05)) - 1.0;
}

TEST_P(EachMagnusScheme, HasItsOrderForExactMomentsAndLessWithAnotherNumber) {
  EXPECT_NEAR(order_of_exponent(scheme), scheme.order_of_sum, 0.2);
  MagnusScheme changed = scheme;
  for (double* number : numbers_of_exponent(changed)) {
    const double before = *number;
    *number *= 1.1;
    EXPECT_LE(order_of_exponent(changed), scheme.order_of_sum - 0.8) << before;
    *number = before;
  }
}

}  // namespace
}  // namespace isosyrk::testing
