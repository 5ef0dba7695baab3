#include "isosyrk/tableaux/gauss_tableau.h"

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Hairer, Lubich, Wanner, Geometric Numerical Integration, Table II.1.1; evaluated in extended
// precision so that the comparison is with the correctly rounded coefficient.
TEST(GaussTableau, AgreesWithTheClosedFormsTo4Ulp) {
  const long double r3 = std::sqrt(3.0L), r15 = std::sqrt(15.0L);
  const std::vector<std::vector<long double>> closed = {
      // a by rows, b, c
      {0.5L, 1.0L, 0.5L},
      {0.25L, 0.25L - r3 / 6, 0.25L + r3 / 6, 0.25L,  //
       0.5L, 0.5L,                                    //
       0.5L - r3 / 6, 0.5L + r3 / 6},
      {5.0L / 36, 2.0L / 9 - r15 / 15, 5.0L / 36 - r15 / 30,  //
       5.0L / 36 + r15 / 24, 2.0L / 9, 5.0L / 36 - r15 / 24,  //
       5.0L / 36 + r15 / 30, 2.0L / 9 + r15 / 15, 5.0L / 36,  //
       5.0L / 18, 4.0L / 9, 5.0L / 18,                        //
       0.5L - r15 / 10, 0.5L, 0.5L + r15 / 10}};
  for (const auto& expected : closed) {
    const int s = static_cast<int>(&expected - closed.data()) + 1;
    const Tableau tableau = gauss_tableau(s);
    RealVector found(s * (s + 2));
    found << tableau.a.transpose().reshaped(), tableau.b, tableau.c;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double value = found(static_cast<Index>(k)), rounded = static_cast<double>(expected[k]);
      EXPECT_DOUBLE_EQ(value, rounded) << s << " " << k;  // to 4 ulp
      EXPECT_TRUE(s > 1 || value == rounded);
    }
  }
}

TEST(GaussTableau, IntegratesPolynomialsOfDegree2sMinus1AndNoMoreByCollocation) {
  for (int s = 1; s <= max_stages; ++s) {
    const Tableau tableau = gauss_tableau(s);
    EXPECT_EQ(tableau.order, 2 * s);
    for (int power = 0; power <= 2 * s; ++power) {
      const RealVector c_power = tableau.c.array().pow(power);
      const double error = std::abs(tableau.b.dot(c_power) - 1.0 / (power + 1));
      if (power < s) {
        const RealVector expected = c_power.cwiseProduct(tableau.c) / (power + 1);
        EXPECT_LE((tableau.a * c_power - expected).cwiseAbs().maxCoeff(), 1e-15)
            << s << " " << power;
      }
      if (power < 2 * s) {
        EXPECT_LE(error, 1e-15) << s << " " << power;
      } else if (s <= 5) {
        EXPECT_GE(error, 1e-9) << s;
      }
    }
  }
}

TEST(GaussTableau, IsSymplecticTo16EpsilonAndRadauIsNot) {
  for (int s = 1; s <= max_stages; ++s) {
    EXPECT_LE(symplecticity_defect(gauss_tableau(s)), 16 * 2.3e-16) << s;
  }
  EXPECT_GE(symplecticity_defect(radau_iia()), 0.05);
}

TEST(Tableau, ThatIsInconsistentOrTooLargeIsRefused) {
  for (const int s : {-1, 0, max_stages + 1}) {
    EXPECT_THROW(gauss_tableau(s), std::invalid_argument);
  }
  const auto expect_refused = [](const auto& change) {
    Tableau tableau = gauss_tableau(2);
    EXPECT_NO_THROW(require_consistent(tableau));
    change(tableau);
    EXPECT_THROW(require_consistent(tableau), std::invalid_argument);
  };
  expect_refused([](Tableau& tableau) { tableau = {}; });
  expect_refused([](Tableau& tableau) { tableau.b.resize(3); });
  expect_refused([](Tableau& tableau) { tableau.a(0, 1) = std::nan(""); });
  expect_refused([](Tableau& tableau) {
    const Index s = max_stages + 1;
    tableau.a = RealMatrix::Zero(s, s);
    tableau.b = tableau.c = RealVector::Constant(s, 1.0 / static_cast<double>(s));
  });
}

}  // namespace
}  // namespace isosyrk::testing
