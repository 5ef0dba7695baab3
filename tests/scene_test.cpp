// Modes, the vorticity matrices made of them, and scenes: the rough one is reproducible, the same
// for every n and of the spectrum that is promised.
#include <cmath>

#include "isosyrk/flows/harmonic.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/laplacian.h"
#include "isosyrk/flows/spherical_harmonics.h"
#include "isosyrk/simulation/conservation.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// With the phases of Condon and Shortley, those of the 3j symbols: T_ll is (-1)^l S_+^l of norm 1,
// and [S_-, T_lm] = sqrt((l + m)(l - m + 1)) T_l,m-1.
TEST(Harmonic, IsLoweredFromAPowerOfTheRaisingMatrix) {
  for (const int n : {6, 7}) {
    const auto S = spin_matrices(n);
    const Complex i(0.0, 1.0);
    const Matrix up = S[0] + i * S[1], down = S[0] - i * S[1];
    Matrix power = Matrix::Identity(n, n);
    for (int l = 0; l < n; ++l) {
      Matrix T = (l % 2 == 0 ? 1.0 : -1.0) / power.norm() * power;
      for (int m = l; m >= 0; --m) {
        const RealVector expected = T.diagonal(m).real();
        EXPECT_LE((harmonic(n, l, m) - expected).cwiseAbs().maxCoeff(), 1e-12) << l << " " << m;
        T = commutator(down, T) / std::sqrt((l + m) * (l - m + 1.0));
      }
      power = product({power, up});
    }
  }
}

TEST(Harmonic, KeepsItsSignWhereTheFirstEntryIsBelowRounding) {
  // T_mm is of one sign; its first entry, relative to the largest, is about 1e-27 here.
  const RealVector T = harmonic(513, 256, 256);
  EXPECT_LT(std::abs(T(0)), 1e-20 * T.cwiseAbs().maxCoeff());
  EXPECT_GT(T.minCoeff(), 0.0);
  EXPECT_LT(harmonic(513, 255, 255).maxCoeff(), 0.0);  // (-1)^m, m odd
  // The next l has one sign change, in the middle: odd, positive at first.
  const RealVector U = harmonic(513, 257, 256);
  EXPECT_GT(U.head(U.size() / 2).minCoeff(), 0.0);
  EXPECT_LT(U.tail(U.size() / 2).maxCoeff(), 0.0);
}

// And so normalised and, since eigenvalues differ, orthogonal to the others of its m.
TEST(Harmonic, IsAUnitEigenvectorToRoundingAtAllSizes) {
  std::vector<std::tuple<int, int, int>> all = {
      {129, 4, 0}, {129, 90, 17}, {1025, 7, 3}, {1025, 1000, 1}};
  for (int l = 0; l < 12; ++l) {
    for (int m = 0; m <= l; ++m) all.emplace_back(12, l, m);
  }
  for (const auto& [n, l, m] : all) {
    const RealVector T = harmonic(n, l, m);
    const RealVector d = Laplacian::diagonal(n, m);
    const RealVector e = Laplacian::off_diagonal(n, m);
    RealVector residual = d.cwiseProduct(T) - l * (l + 1.0) * T;
    residual.head(n - m - 1) += e.cwiseProduct(T.tail(n - m - 1));
    residual.tail(n - m - 1) += e.cwiseProduct(T.head(n - m - 1));
    // A few roundings of the matrix, whose norm is n² at most.
    EXPECT_LE(residual.norm(), 1e-15 * n * n) << n << " " << l << " " << m;
    EXPECT_NEAR(T.norm(), 1.0, 1e-15);
  }
}

TEST(HarmonicCoefficients, AreThoseOfTheModesAndTheTrace) {
  const Index n = 7;
  const std::vector<Mode> modes = {{1, 0, 0.5}, {3, 2, {-0.2, 0.7}}, {6, 6, {1.0, -0.1}}};
  Matrix W = vorticity_from_modes(modes, n);
  W += Complex(0.0, 0.3) * Matrix::Identity(n, n);
  const Matrix found = harmonic_coefficients(W);
  Matrix expected = Matrix::Zero(n, n);
  const double factor = found(1, 0).real() / 0.5;
  for (const Mode& mode : modes) expected(mode.l, mode.m) = factor * mode.value;
  expected(0, 0) = 0.3 * std::sqrt(static_cast<double>(n));
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(factor, 0.1);
}

// Σ_m |Y_lm|² = 2l + 1 over m = -l..l at every point: the addition theorem.
TEST(SphericalHarmonics, HaveTheSquaresOfTheAdditionTheorem) {
  RealVector latitudes(5);
  latitudes << -1.5, -0.2, 0.0, 1e-8, std::acos(0.0);
  for (const Index n : {2, 65, 514}) {
    for (const Index l : {Index{1}, n / 2, n - 1}) {
      Matrix coefficients = Matrix::Zero(n, n);
      coefficients.row(l).head(l + 1).setOnes();
      const Matrix values = along_latitudes(coefficients, latitudes);
      for (Index row = 0; row < latitudes.size(); ++row) {
        const double sum = 2.0 * values.row(row).squaredNorm() - std::norm(values(row, 0));
        EXPECT_NEAR(sum / (2.0 * static_cast<double>(l) + 1.0), 1.0, 1e-13) << n << " " << l;
        if (l == 1) {
          EXPECT_NEAR(values(row, 0).real(), std::sqrt(3.0) * std::sin(latitudes(row)), 1e-15);
          EXPECT_NEAR(values(row, 1).real(), std::sqrt(1.5) * std::cos(latitudes(row)), 1e-15);
        }
      }
    }
  }
}

TEST(InitialVorticity, IsSkewHermitianTraceFreeAndOfNorm1) {
  for (const Index n : {5, 6, 17, 34, 129}) {
    for (const auto& modes : {default_modes(), rough_modes(n)}) {
      const Matrix W = vorticity_from_modes(modes, n);
      EXPECT_EQ(skew_defect(W), 0.0);
      EXPECT_NEAR(std::abs(W.trace()), 0.0, 1e-14);
      EXPECT_NEAR(spectral_norm(W), 1.0, 1e-14);
    }
  }
}

TEST(InitialVorticity, DoesNotDependOnTheScaleOfTheModes) {
  const Matrix W = vorticity_from_modes({{1, 1, {0.3, -0.8}}, {2, 0, 0.5}}, 9);
  for (const double scale : {0x1p900, 0x1p-900, 0x1p1000}) {
    const Matrix V =
        vorticity_from_modes({{1, 1, {0.3 * scale, -0.8 * scale}}, {2, 0, 0.5 * scale}}, 9);
    EXPECT_EQ(W, V) << scale;
  }
  const double smallest = std::numeric_limits<double>::denorm_min();
  EXPECT_TRUE(vorticity_from_modes({{2, 1, smallest}}, 9).allFinite());
}

TEST(InitialVorticity, GivesTheStatedStiffnessAtEverySize) {
  // h |B(W0)| at h = 0.1, as stated for these modes.
  for (const auto& [n, stated] : {std::pair{17, 0.140}, {33, 0.253}, {65, 0.479}, {129, 0.930}}) {
    EXPECT_NEAR(0.1 * generator_norms(smooth_scene(n)).B, stated, 0.0006) << n;
  }
}

// What else is refused is tested from outside, with the messages; see
// tests/scripts/test_integrate.py.
TEST(Modes, ThatDoNotFitAreRefusedByName) {
  expect_refused([] { require_valid({}, 5); }, "nonzero");
  expect_refused([] { require_valid(default_modes(), 4); }, "l=4");
  EXPECT_NO_THROW(require_valid({{1, 0, 1.0}}, 2));
}

TEST(RoughModes, FillEveryScaleAndAreTheSameForEveryN) {
  const std::vector<Mode> few = rough_modes(9), many = rough_modes(33);
  EXPECT_EQ(many.size(), 33U * 34U / 2U - 1U);  // l = 1..n-1, m = 0..l
  EXPECT_NO_THROW(require_valid(many, 33));
  for (std::size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(few[k].l, many[k].l);
    EXPECT_EQ(few[k].m, many[k].m);
    EXPECT_EQ(few[k].value, many[k].value);
  }
}

// Energy at l: |ω_l0|² + 2 Σ |ω_lm|² over l(l+1), on average 1/l³.  Summed over 16 <= l < 256, of
// some 30000 independent normal numbers, the mean of l³ E_l is 1 to within a few per cent.
TEST(RoughModes, EnergyFallsAsTheThirdPower) {
  const int first = 16;
  const int end = 256;
  std::vector<double> energy(end, 0.0);
  for (const Mode& mode : rough_modes(end)) {
    const double weight = mode.m == 0 ? 1.0 : 2.0;
    energy[static_cast<std::size_t>(mode.l)] +=
        weight * std::norm(mode.value) / (mode.l * (mode.l + 1.0));
  }
  double mean = 0.0;
  for (int l = first; l < end; ++l) {
    mean += std::pow(l, 3) * energy[static_cast<std::size_t>(l)] / (end - first);
  }
  EXPECT_NEAR(mean, 1.0, 0.1);
}

}  // namespace
}  // namespace isosyrk::testing
