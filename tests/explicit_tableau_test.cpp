// Coefficients and limits of the explicit methods.
#include "isosyrk/tableaux/explicit_tableaux.h"
#include "isosyrk/tableaux/multistep_schemes.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

const std::vector<const ExplicitScheme*>& schemes() {
  static const std::vector<const ExplicitScheme*> all = {
      &classical_runge_kutta4(), &dormand_prince5(), &dormand_prince8(), &feagin10()};
  return all;
}

// Orders are tested on the flow by all methods' tests.  Here, what finds a digit that is wrong: the
// rows against nodes that the literature gives, and the conditions of quadrature.
TEST(ExplicitTableaux, IntegratePolynomialsBelowTheirOrderAndNoMore) {
  for (const ExplicitScheme* scheme : schemes()) {
    const Tableau& tableau = scheme->tableau;
    EXPECT_NO_THROW(require_explicit(tableau));
    for (int power = 0; power <= tableau.order; ++power) {
      const RealVector c_power = tableau.c.array().pow(power);
      const double error = std::abs(tableau.b.dot(c_power) - 1.0 / (power + 1));
      const double between =
          std::abs(tableau.b.dot(tableau.a * c_power) - 1.0 / ((power + 1.0) * (power + 2.0)));
      // The nodes are sums over coefficients up to 43.
      EXPECT_EQ(error <= 4e-15, power < tableau.order) << tableau.name << power << " " << error;
      if (power < tableau.order - 1) {
        EXPECT_LE(between, 4e-15) << tableau.name << power;
      }
    }
  }
}

TEST(ExplicitTableaux, HaveTheNodesThatTheirSourcesGive) {
  const double r6 = std::sqrt(6.0);
  RealVector nodes(12);
  nodes << 0.0, (12.0 - 2.0 * r6) / 135.0, (6.0 - r6) / 45.0, (6.0 - r6) / 30.0, (6.0 + r6) / 30.0,
      1.0 / 3.0, 1.0 / 4.0, 4.0 / 13.0, 127.0 / 195.0, 3.0 / 5.0, 6.0 / 7.0, 1.0;
  EXPECT_LE((dormand_prince8().tableau.c - nodes).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_DOUBLE_EQ(dormand_prince5().tableau.c(3), 0.8);
  // Feagin's are symmetric about 1/2: 0, 0.1 ... 0.9, 1, with nodes of Lobatto's quadrature.
  const RealVector c = feagin10().tableau.c;
  EXPECT_NEAR(c(1), 0.1, 1e-16);
  EXPECT_NEAR(c(15), 0.1, 1e-15);
  EXPECT_NEAR(c(16), 1.0, 1e-14);
}

TEST(ExplicitTableaux, AreStableOnTheImaginaryAxisUpToTheirLimitAndNoFurther) {
  for (const ExplicitScheme* scheme : schemes()) {
    const double limit = scheme->imaginary_limit;
    double largest = 0.0;
    for (int k = 1; k <= 1000; ++k) {
      largest = std::max(largest, std::abs(stability_function(scheme->tableau, limit * k / 1000)));
    }
    EXPECT_LE(largest, 1.0 + 1e-12) << scheme->tableau.name;
    EXPECT_GT(std::abs(stability_function(scheme->tableau, 1.01 * limit)), 1.0 + 1e-7)
        << scheme->tableau.name;
  }
}

TEST(ExplicitTableaux, MustBeExplicit) {
  Tableau tableau = classical_runge_kutta4().tableau;
  tableau.a(2, 2) = 0.5;
  expect_refused([&] { require_explicit(tableau); }, "tableau rk4: a(3, 3) must be 0");
}

// The integrals of the polynomial through the slopes.
TEST(MultistepSchemes, IntegratePolynomialsBelowTheirOrderAndNoMore) {
  const MultistepScheme& scheme = adams_bashforth_moulton8();
  const Index count = scheme.predictor.size();
  ASSERT_EQ(scheme.corrector.size(), count);
  for (int power = 0; power <= scheme.order; ++power) {
    const double exact = 1.0 / (power + 1);
    double predicted = 0.0, corrected = scheme.of_predicted;
    for (Index j = 0; j < count; ++j) {
      const double slope = std::pow(-static_cast<double>(j), power);
      predicted += scheme.predictor(j) * slope;
      corrected += scheme.corrector(j) * slope;
    }
    const double rounding = 1e-15 * std::pow(6.0, power);
    EXPECT_EQ(std::abs(predicted - exact) <= rounding, power < scheme.order - 1) << power;
    EXPECT_EQ(std::abs(corrected - exact) <= rounding, power < scheme.order) << power;
  }
}

TEST(MultistepSchemes, GrowNothingUpToTheirLimitAndBeyondItDo) {
  const MultistepScheme& scheme = adams_bashforth_moulton8();
  for (int k = 1; k <= 100; ++k) {
    EXPECT_LE(growth_of_a_step(scheme, scheme.imaginary_limit * k / 100), 1.0 + 1e-13) << k;
  }
  EXPECT_GT(growth_of_a_step(scheme, 1.01 * scheme.imaginary_limit), 1.001);
}

}  // namespace
}  // namespace isosyrk::testing
