// Conserved quantities of known matrices, and what is reported of changes whose effect is known.
#include <array>

#include "isosyrk/flows/invariants.h"
#include "isosyrk/simulation/conservation.h"
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

// Each eigenvalue is paired once: i, i against i, -i lie 2 apart, though each of the former is one
// of the latter.
TEST(Spectrum, OfAnotherAlgebraIsComparedInPairs) {
  const QuadraticAlgebra algebra(indefinite_J(1, 1));
  const auto diagonal = [](double first, double second) {
    Matrix W = Matrix::Zero(2, 2);
    W.diagonal() << Complex(0.0, first), Complex(0.0, second);
    return W;
  };
  const auto error = [&](const Matrix& W, const Matrix& V) {
    return spectrum_error(algebra, W, V);
  };
  EXPECT_EQ(error(diagonal(1.0, -1.0), diagonal(1.0, 1.0)), 2.0);
  EXPECT_EQ(error(diagonal(1.0, 1.0), diagonal(1.0, -1.0)), 2.0);
  EXPECT_EQ(error(diagonal(1.0, -1.0), diagonal(-1.0, 1.0)), 0.0) << "whatever their order";
  EXPECT_EQ(error(diagonal(1.0, 1.0), diagonal(1.0, 1.25)), 0.25);
}

TEST(Spectrum, OfBlocksIsThatOfTheWorstWhereverItStands) {
  const Scene scene = scene_by_name("spin_chain", 8);
  const Matrix& W = scene.initial;
  for (Index at = 0; at < W.rows(); at += 2) {
    Matrix disturbed = W;
    disturbed.block(at, at, 2, 2) *= 1.5;
    const double size = W.block(at, at, 2, 2).norm() / std::sqrt(2.0);  // eigenvalues ±i size
    EXPECT_NEAR(spectrum_error(scene.flow->algebra(), disturbed, W), 0.5 * size, 1e-14) << at;
    EXPECT_NEAR(spectrum_error(scene.flow->algebra(), W, disturbed), 0.5 * size, 1e-14) << at;
  }
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

constexpr Index n = 9;

// (1 + e) W: eigenvalues and angular momentum grow by 1 + e, energy by (1 + e)², tr W^k by
// (1 + e)^k; nothing at all with e = 0.
TEST(ConservationWatch, ScalingIsSeenInEveryQuantity) {
  const Scene scene = smooth_scene(n);
  const auto L = angular_momentum(scene.initial);
  const double component =
      std::max({std::abs(L[0]), std::abs(L[1]), std::abs(L[2])}) / std::hypot(L[0], L[1], L[2]);
  for (const double e : {0.0, 1e-3}) {
    const Matrix W = (1.0 + e) * scene.initial;
    const double rounding = e == 0.0 ? 0.0 : 1e-13;
    ConservationWatch watch(scene);
    watch.observe(W);
    const Conservation kept = watch.report(W);
    EXPECT_EQ(kept.skew_defect, 0.0);
    EXPECT_NEAR(kept.spectrum_error, e, rounding);  // the largest eigenvalue is 1
    EXPECT_NEAR(kept.energy_error, 2.0 * e + e * e, rounding);
    EXPECT_NEAR(angular_momentum_error(W, scene.initial), e * component, rounding);
    const auto casimirs = casimir_errors(W, scene.initial);
    if (e == 0.0) {
      EXPECT_EQ(casimirs, (std::array<double, 4>{}));
    }
    for (const int k : {2, 4}) {  // |tr W^k| = Σ|λ|^k for even k
      EXPECT_NEAR(casimirs[static_cast<std::size_t>(k - 2)], std::pow(1.0 + e, k) - 1.0, rounding);
    }
  }
}

TEST(ConservationWatch, EnergyErrorIsTheLargestOfTheRunOrNan) {
  const Scene scene = smooth_scene(n);
  ConservationWatch watch(scene);
  const auto error_after = [&](double factor) {
    watch.observe(factor * scene.initial);
    watch.observe(scene.initial);
    return watch.report(scene.initial).energy_error;
  };
  EXPECT_NEAR(error_after(1.01), 1.01 * 1.01 - 1.0, 1e-13);
  EXPECT_TRUE(std::isnan(error_after(std::nan(""))));
}

// A power of two changes no digit.
TEST(ConservationWatch, ErrorsOfAnyNormAreThoseOfNormOne) {
  const auto errors = [](double factor) {
    Scene scene = smooth_scene(n);
    const Matrix W = factor * (1.01 * scene.initial);
    scene.initial *= factor;
    ConservationWatch watch(scene);
    watch.observe(W);
    const auto [c2, c3, c4, c5] = casimir_errors(W, scene.initial);
    return std::array{watch.report(W).energy_error, c2, c4,
                      angular_momentum_error(W, scene.initial)};
  };
  const auto expected = errors(1.0);
  for (const int exponent : {-1000, -515, -100, 100, 515, 1000}) {
    const auto found = errors(std::ldexp(1.0, exponent));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], 1e-13) << exponent << " " << i;
    }
  }
  EXPECT_NEAR(expected[0], 1.01 * 1.01 - 1.0, 1e-13);
}

TEST(Energy, OfAnyNormIsThatOfNormOneTimesTheSquareOrThrows) {
  for (const std::string& name : scene_names()) {
    const Scene scene = scene_by_name(name, name == "euler_top" ? 3 : 8);
    const double energy = scene.flow->energy(scene.initial);
    if (scene.flow->algebra().is_dense()) {
      EXPECT_EQ(energy, scene.flow->hamiltonian(scene.initial)) << name;
    }
    for (const int exponent : {-1000, -560, -100, -3, 3, 100, 560, 1000}) {
      const Energy scaled = scene.flow->energy(std::ldexp(1.0, exponent) * scene.initial);
      EXPECT_EQ(scaled.over(scene.flow->energy(scene.initial)), std::ldexp(1.0, 2 * exponent));
      if (std::abs(exponent) > 512) {
        EXPECT_FALSE(scaled.is_double());
        EXPECT_THROW(scaled.value(), std::range_error);
        EXPECT_NEAR(scaled.log10(), std::log10(std::abs(energy)) + 2 * exponent * std::log10(2.0),
                    1e-9);
      } else {
        EXPECT_EQ(scaled.value(), std::ldexp(energy, 2 * exponent)) << name << " " << exponent;
      }
    }
  }
}

TEST(Energy, OfZeroAndOfWhatIsNotFiniteIsReturned) {
  const Scene scene = smooth_scene(n);
  EXPECT_EQ(scene.flow->energy(0.0 * scene.initial).value(), 0.0);
  EXPECT_TRUE(std::isnan(scene.flow->energy(std::nan("") * scene.initial).value()));
  EXPECT_TRUE(std::isinf(Energy(std::numeric_limits<double>::infinity()).value()));
}

TEST(ConservationWatch, ASkewDefectOfASingleEntryIsSeen) {
  const Scene scene = smooth_scene(n);
  Matrix W = scene.initial;
  W(2, 3) += 1e-6;
  EXPECT_NEAR(ConservationWatch(scene).report(W).skew_defect, 1e-6, 1e-15);
}

// ad_B is diagonal in the eigenbasis of B: its eigenvalues are the differences of those of B.
TEST(GeneratorNorms, AreThoseOfBAndOfItsAdjointAction) {
  const Scene scene = smooth_scene(n);
  Matrix B(n, n);
  scene.flow->generator(scene.initial, B);
  const RealVector eigenvalues = spectrum(B);
  const GeneratorNorms norms = generator_norms(scene);
  EXPECT_DOUBLE_EQ(norms.B, spectral_norm(B));
  EXPECT_DOUBLE_EQ(norms.ad_B, eigenvalues(n - 1) - eigenvalues(0));
  EXPECT_GT(norms.ad_B, norms.B);
  EXPECT_LE(norms.ad_B, 2.0 * norms.B);
}

}  // namespace
}  // namespace isosyrk::testing
