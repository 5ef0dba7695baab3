#include "isosyrk/flows/invariants.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "isosyrk/flows/scene.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(Spectrum, IsThatOfTheMatrixItWasMadeFrom) {
  const Index n = 8;
  const RealVector wanted = RealVector::LinSpaced(n, -2.0, 1.5);
  const Matrix U = exponential(random_skew_hermitian(n, 1));  // unitary
  const Matrix W =
      product({U, Complex(0.0, 1.0) * Matrix(wanted.cast<Complex>().asDiagonal()), U.adjoint()});
  EXPECT_LE((spectrum(W) - wanted).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_NEAR(spectral_norm(W), 2.0, 1e-14);
}

TEST(Spectrum, RefusesWhatHasNone) {
  EXPECT_THROW(spectrum(Matrix::Zero(2, 3)), std::invalid_argument);
  Matrix W = Matrix::Zero(3, 3);
  W(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(spectrum(W), std::invalid_argument);
}

TEST(Casimir, IsTheTraceOfThePower) {
  const Matrix W = random_matrix(5, 1);
  EXPECT_LE(std::abs(casimir(W, 1) - W.trace()), 1e-15);
  EXPECT_LE(std::abs(casimir(W, 3) - product({W, W, W}).trace()), 1e-13);
  EXPECT_THROW(casimir(W, 0), std::invalid_argument);
}

TEST(AngularMomentum, IsTheTraceWithTheSpinMatrices) {
  const Matrix W = random_skew_hermitian(7, 2);
  const auto S = spin_matrices(7);
  const auto momentum = angular_momentum(W);
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(momentum[a], product({S[a], W}).trace().imag(), 1e-14);
}

TEST(EulerZeitlin, HasTheTwoValuesOfHbar) {
  EXPECT_DOUBLE_EQ(hbar(HbarConvention::paper, 17), 2.0 / std::sqrt(17.0 * 16.0));
  EXPECT_DOUBLE_EQ(hbar(HbarConvention::standard, 17), 2.0 / std::sqrt(288.0));
}

TEST(EulerZeitlin, HasPositiveEnergyWhoseGradientIsTheStreamMatrix) {
  const Scene scene = smooth_scene(9);
  const Matrix& W = scene.initial;
  EXPECT_GT(scene.flow->hamiltonian(W), 0.0);
  // dH(W)[V] = -<P, V>, with P = hbar B(W): by central differences, exact for a quadratic H.
  const Matrix V =
      smooth_scene(9, HbarConvention::paper, {{5, 3, {0.3, -1.0}}, {2, 2, 1.0}}).initial;
  Matrix B(9, 9);
  scene.flow->generator(W, B);
  const Matrix P = hbar(HbarConvention::paper, 9) * B;
  const double derivative = 0.5 * (scene.flow->hamiltonian(W + V) - scene.flow->hamiltonian(W - V));
  EXPECT_NEAR(derivative, -product({P.adjoint(), V}).trace().real(), 1e-14);
}

}  // namespace
}  // namespace isosyrk::testing
