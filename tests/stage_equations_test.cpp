// The stage equations of the published forms, in one pass, against the same expressions written
// out.
#include <limits>

#include "isosyrk/integrators/stage_equations.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// n odd and even, so that the last few real numbers are taken apart; s below, at and above the
// counts that are unrolled.
class StageSums : public ::testing::TestWithParam<std::pair<Index, int>> {
 protected:
  std::vector<Matrix> random_stages() const {
    std::vector<Matrix> Y;
    const auto [n, s] = GetParam();
    for (int j = 0; j < s; ++j) Y.push_back(Matrix::Random(n, n));
    return Y;
  }
};

TEST_P(StageSums, UpdateUnknownsIsTheStageEquationAndItsChangeAndSeesNan) {
  const auto [n, s] = GetParam();
  const double h = -0.3;
  const RealMatrix a = gauss_tableau(s).a;
  const Matrix base = Matrix::Random(n, n);
  std::vector<Matrix> Y = random_stages(), X = random_stages();
  const std::vector<Matrix> old = X;
  RealVector squares(s);
  update_unknowns(base, h, a, Y, X, squares.data());
  for (int i = 0; i < s; ++i) {
    Matrix expected = base;
    for (int j = 0; j < s; ++j) expected += h * a(i, j) * Y[static_cast<std::size_t>(j)];
    const auto at = static_cast<std::size_t>(i);
    EXPECT_LE((X[at] - expected).cwiseAbs().maxCoeff(), 1e-14 * s);
    const double change = (expected - old[at]).squaredNorm();
    EXPECT_NEAR(squares(i), change, 1e-13 * change);
  }
  EXPECT_TRUE(std::isfinite(largest_change(squares)));
  Y.back()(n - 1, n - 1) = Complex(nan, 0.0);
  update_unknowns(base, h, a, Y, X, squares.data());
  EXPECT_TRUE(std::isnan(largest_change(squares)));
}

INSTANTIATE_TEST_SUITE_P(SizesAndStages, StageSums,
                         ::testing::ValuesIn(std::vector<std::pair<Index, int>>{
                             {2, 1}, {3, 2}, {5, 3}, {6, 4}, {17, 3}, {17, 7}, {4, max_stages}}));

// Entries are below 8, and each is a sum of few terms.
constexpr double rounding = 1e-14;

TEST(Updates, AreTheirEquationsAndReturnTheirChangesOrNan) {
  for (const QuadraticAlgebra& algebra :
       {QuadraticAlgebra::skew_hermitian(6), QuadraticAlgebra(symplectic_J(3)),
        QuadraticAlgebra(indefinite_J(4, 2))}) {
    const Index n = algebra.size();
    const auto random = [n] { return Matrix(Matrix::Random(n, n)); };
    const Matrix W0 = random(), S = random(), old = random();
    Matrix Y = random(), W(n, n), scratch(n, n), adjoint(n, n);
    algebra.involution(Y, adjoint);
    const auto vorticity = [&] {
      W = old;
      return update_stage_vorticity(algebra, W0, S, Y, scratch, W);
    };
    const auto midpoint_vorticity = [&] {
      W = old;
      return update_midpoint_vorticity(algebra, W0, 0.3, Y, 0.7, S, scratch, W);
    };
    const auto expect = [&](const Matrix& expected, double change) {
      EXPECT_LE((W - expected).cwiseAbs().maxCoeff(), rounding);
      EXPECT_NEAR(change, (expected - old).squaredNorm(), 100.0 * rounding);
    };
    double change = vorticity();
    expect(W0 + S - adjoint, change);
    change = midpoint_vorticity();
    expect(W0 + 0.3 * (Y - adjoint) + 0.7 * S, change);
    add_commutator(algebra, W0, Y, scratch, W);
    expect(W0 + Y - adjoint, (W - old).squaredNorm());
    Y(n - 1, 0) = nan;
    EXPECT_TRUE(std::isnan(vorticity()));
    EXPECT_TRUE(std::isnan(midpoint_vorticity()));
  }
}

}  // namespace
}  // namespace isosyrk::testing
