// Sums over stages and updates in one pass against the same expressions written out.
#include "isosyrk/linalg/operations.h"

#include <gtest/gtest.h>

#include <limits>

#include "isosyrk/split/split_sums.h"
#include "isosyrk/tableaux/gauss_tableau.h"

namespace isosyrk {
namespace {

// n odd and even, so that the last few real numbers are taken apart; s below, at and above the
// counts that are unrolled.
struct Sizes {
  Index n;
  int s;
};

class StageSums : public ::testing::TestWithParam<Sizes> {
 protected:
  std::vector<Matrix> random_stages() const {
    std::vector<Matrix> Y;
    for (int j = 0; j < GetParam().s; ++j) Y.push_back(Matrix::Random(GetParam().n, GetParam().n));
    return Y;
  }
};

TEST_P(StageSums, UpdateUnknownsIsTheStageEquationAndItsChange) {
  const auto [n, s] = GetParam();
  const double h = -0.3;
  const RealMatrix a = gauss_tableau(s).a;
  const Matrix base = Matrix::Random(n, n);
  const std::vector<Matrix> Y = random_stages();
  std::vector<Matrix> X = random_stages();
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
}

TEST_P(StageSums, CombineIsTheWeightedSum) {
  const auto [n, s] = GetParam();
  const RealVector b = gauss_tableau(s).b;
  const Matrix base = Matrix::Random(n, n);
  const std::vector<Matrix> Y = random_stages();
  Matrix expected = Matrix::Zero(n, n);
  for (int j = 0; j < s; ++j) expected += b(j) * Y[static_cast<std::size_t>(j)];
  Matrix sum(n, n);
  combine(b, Y, sum);
  EXPECT_LE((sum - expected).cwiseAbs().maxCoeff(), 1e-15 * s);
  combine(base, b, Y, sum);
  EXPECT_LE((sum - (base + expected)).cwiseAbs().maxCoeff(), 1e-15 * (s + 1));
}

TEST_P(StageSums, AChangeThatIsNotANumberIsSeen) {
  const auto [n, s] = GetParam();
  std::vector<Matrix> Y = random_stages();
  Y.back()(n - 1, n - 1) = Complex(std::numeric_limits<double>::quiet_NaN(), 0.0);
  std::vector<Matrix> X = random_stages();
  RealVector squares(s);
  update_unknowns(Matrix::Zero(n, n), 1.0, gauss_tableau(s).a, Y, X, squares.data());
  EXPECT_TRUE(std::isnan(largest_change(squares)));
}

TEST_P(StageSums, OneUnknownByItselfIsTheSameBitForBit) {
  const auto [n, s] = GetParam();
  const RealMatrix a = gauss_tableau(s).a;
  const auto compare = [&]<class Real>(const auto& base, std::vector<PlanarMatrixOf<Real>> X) {
    std::vector<PlanarMatrixOf<Real>> Y;
    for (const Matrix& each : random_stages()) Y.emplace_back(each);
    const auto old = X;
    for (const Share half : {Share{0, 2}, Share{1, 2}}) {
      RealVector squares(s);
      const NumbersOfRows numbers(X[0], half);
      update_unknowns(base, -0.3, a, Y, X, squares.data(), numbers.begin, numbers.end);
      for (std::size_t i = 0; i < X.size(); ++i) {
        PlanarMatrixOf<Real> alone = old[i];
        const auto row = static_cast<Index>(i);
        EXPECT_EQ(update_unknown(base, -0.3, a, row, Y, alone, half), squares(row));
        EXPECT_TRUE((reals(alone, half) == reals(X[i], half)).all()) << i;
        EXPECT_FALSE((reals(alone, half) == reals(old[i], half)).all()) << i;
      }
    }
  };
  std::vector<PlanarMatrix> X;
  std::vector<SingleMatrix> singles, bases;
  for (const Matrix& each : random_stages()) {
    X.emplace_back(each);
    singles.emplace_back(each);
    bases.emplace_back(Matrix::Random(n, n));
  }
  compare(PlanarMatrix(Matrix::Random(n, n)), X);
  compare(bases, singles);
}

TEST(PlanarSums, OfAnyNumberOfTermsAreTheirSum) {
  for (const Index n : {1, 5, 17, 34}) {
    std::vector<PlanarMatrix> X;
    Terms<double> terms;
    Matrix expected = Matrix::Zero(n, n);
    for (std::size_t count = 1; count <= 9; ++count) {
      const double weight = 0.3 * static_cast<double>(count) - 1.0;
      X.emplace_back(Matrix::Random(n, n));
      expected += weight * X.back().interleaved();
      terms = {};
      for (std::size_t t = 0; t < X.size(); ++t) {
        terms.add(0.3 * static_cast<double>(t + 1) - 1.0, X[t]);
      }
      PlanarMatrix sum(n), again(Matrix::Random(n, n)), beside(n);
      assign(sum, Share{0, 2}, terms);
      assign(sum, Share{1, 2}, terms);
      EXPECT_LE((sum.interleaved() - expected).cwiseAbs().maxCoeff(), 1e-14) << n << " " << count;
      const double change = (again.interleaved() - expected).squaredNorm();
      const Matrix old = again.interleaved();
      EXPECT_NEAR(replace(again, beside, Share{}, terms), change, 1e-13 * (1.0 + change));
      EXPECT_EQ(again.interleaved(), old);
      EXPECT_LE((beside.interleaved() - expected).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_NEAR(replace(again, Share{}, terms), change, 1e-13 * (1.0 + change));
      EXPECT_EQ(again.entries(), beside.entries());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndStages, StageSums,
                         ::testing::Values(Sizes{2, 1}, Sizes{3, 2}, Sizes{5, 3}, Sizes{6, 4},
                                           Sizes{17, 3}, Sizes{17, 7}, Sizes{4, max_stages}));

// J = I, symplectic and indefinite J.
std::vector<QuadraticAlgebra> algebras() {
  Matrix symplectic = Matrix::Zero(6, 6);
  symplectic.topRightCorner(3, 3).setIdentity();
  symplectic.bottomLeftCorner(3, 3) = -Matrix::Identity(3, 3);
  Matrix indefinite = Matrix::Identity(6, 6);
  indefinite(4, 4) = indefinite(5, 5) = -1.0;
  return {QuadraticAlgebra::skew_hermitian(6), QuadraticAlgebra(symplectic),
          QuadraticAlgebra(indefinite)};
}

// Entries are below 8, and each is a sum of few terms.
constexpr double rounding = 1e-14;

TEST(Updates, AreTheirEquationsAndReturnTheirChanges) {
  for (const QuadraticAlgebra& algebra : algebras()) {
    const Index n = algebra.size();
    const auto random = [n] { return Matrix(Matrix::Random(n, n)); };
    const Matrix W0 = random(), S = random(), Y = random(), old = random();
    Matrix scratch(n, n), adjoint(n, n);
    algebra.involution(Y, adjoint);
    const auto expect = [&](const Matrix& expected, const Matrix& W, double change) {
      EXPECT_LE((W - expected).cwiseAbs().maxCoeff(), rounding);
      EXPECT_NEAR(change, (expected - old).squaredNorm(), 100.0 * rounding);
    };

    Matrix W = old;
    double change = update_stage_vorticity(algebra, W0, S, Y, scratch, W);
    expect(W0 + S - adjoint, W, change);

    W = old;
    change = update_midpoint_vorticity(algebra, W0, 0.3, Y, 0.7, S, scratch, W);
    expect(W0 + 0.3 * (Y - adjoint) + 0.7 * S, W, change);

    add_commutator(algebra, W0, Y, scratch, W);
    expect(W0 + Y - adjoint, W, (W - old).squaredNorm());
  }
}

TEST(Updates, SeeAChangeThatIsNotANumber) {
  for (const QuadraticAlgebra& algebra : algebras()) {
    const Index n = algebra.size();
    const Matrix zero = Matrix::Zero(n, n);
    Matrix bad = zero;
    bad(n - 1, 0) = std::numeric_limits<double>::quiet_NaN();
    Matrix scratch(n, n);
    Matrix W = zero;
    EXPECT_TRUE(std::isnan(update_stage_vorticity(algebra, zero, zero, bad, scratch, W)));
    W = zero;
    EXPECT_TRUE(
        std::isnan(update_midpoint_vorticity(algebra, zero, 1.0, bad, 1.0, zero, scratch, W)));
  }
}

TEST(RequireConsistent, RefusesMoreStagesThanTheSumsHaveRoomFor) {
  Tableau tableau = gauss_tableau(1);
  const Index s = max_stages + 1;
  tableau.a = RealMatrix::Zero(s, s);
  tableau.b = tableau.c = RealVector::Constant(s, 1.0 / static_cast<double>(s));
  EXPECT_THROW(require_consistent(tableau), std::invalid_argument);
}

}  // namespace
}  // namespace isosyrk
