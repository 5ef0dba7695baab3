// What must fail, fails: the misprint, a tableau that is not symplectic, Gauss applied to W.
#include <Eigen/Dense>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Which B stands in front of K_ij.
enum class KIndex {
  corrected,  // h B(W̃_j) ( ... )
  printed,    // h B(W̃_i) ( ... ), as the paper has it
};

// So many steps of ISOSYRK for J = I, as the equations read and with no thought of speed, each
// iterated to tolerance 1e-14 or 200 sweeps.
Matrix plain_isosyrk(const Flow& flow, const Tableau& tableau, KIndex index, const Matrix& W0,
                     double h, long steps) {
  if (steps == 0) return W0;
  const Index n = flow.size();
  const auto s = static_cast<std::size_t>(tableau.stages());
  const auto a = [&](std::size_t i, std::size_t j) {
    return tableau.a(static_cast<Index>(i), static_cast<Index>(j));
  };
  std::vector<Matrix> X(s, Matrix::Zero(n, n)), B = X, W(s, W0);
  std::vector<std::vector<Matrix>> K(s, X);
  double change = 1.0;
  for (int sweep = 0; sweep < 200 && change >= 1e-14; ++sweep) {
    const auto X_old = X;
    const auto K_old = K;
    for (std::size_t i = 0; i < s; ++i) flow.generator(W[i], B[i]);
    for (std::size_t i = 0; i < s; ++i) {
      Matrix sum_X = Matrix::Zero(n, n);
      for (std::size_t j = 0; j < s; ++j) sum_X += a(i, j) * X_old[j];
      X[i] = -h * product({W0 + sum_X, B[i]});
      for (std::size_t j = 0; j < s; ++j) {
        Matrix sum_K = sum_X;
        for (std::size_t k = 0; k < s; ++k) sum_K += a(j, k) * K_old[i][k];
        K[i][j] = h * product({B[index == KIndex::corrected ? j : i], sum_K});
      }
    }
    change = 0.0;
    for (std::size_t i = 0; i < s; ++i) {
      const Matrix old = W[i];
      W[i] = W0;
      for (std::size_t j = 0; j < s; ++j) W[i] += a(i, j) * (X[j] - X[j].adjoint() + K[i][j]);
      change = std::max(change, (W[i] - old).norm());
    }
  }
  Matrix W1 = W0;
  for (std::size_t i = 0; i < s; ++i) {
    flow.generator(W[i], B[i]);
    const Matrix C = product({B[i], W[i]});
    W1 += h * tableau.b(static_cast<Index>(i)) * (C - C.adjoint());
  }
  return plain_isosyrk(flow, tableau, index, W1, h, steps - 1);
}

// The index as corrected gives the method.
TEST(PrintedKIndex, BreaksSpectrumAndCoincidenceAtTwoAndThreeStagesButNotAtOne) {
  const Scene scene = smooth_scene(17);
  for (const int s : {1, 2, 3}) {
    const Matrix group =
        integrated(*gauss(Formulation::group, *scene.flow, s), scene.initial, 0.1, 50);
    for (const KIndex index : {KIndex::corrected, KIndex::printed}) {
      const Matrix W = plain_isosyrk(*scene.flow, gauss_tableau(s), index, scene.initial, 0.1, 50);
      const double difference = largest_difference(W, group);
      const double drift = spectrum_error(W, scene.initial);
      if (s == 1 || index == KIndex::corrected) {
        EXPECT_LE(difference, 1e-11) << s;
        EXPECT_LE(drift, 1e-12) << s;
      } else {
        EXPECT_GE(difference, 1e-7) << s;
        EXPECT_GE(drift, 1e-7) << s;
      }
    }
  }
}

TEST(PrintedKIndex, DropsTheOrderToThree) {
  const Scene scene = smooth_scene(9);
  const Matrix exact =
      integrated(*gauss(Formulation::group, *scene.flow, 5, 1e-15), scene.initial, 0.05, 40);
  const auto error = [&](double h, long count) {
    return largest_difference(
        plain_isosyrk(*scene.flow, gauss_tableau(3), KIndex::printed, scene.initial, h, count),
        exact);
  };
  const double order = observed_order(2.0, {8, 12, 16, 24, 32}, error, [](long) { return 0.0; });
  EXPECT_NEAR(order, 3.0, 0.4);
}

TEST(NonSymplecticTableau, LosesTheSpectrumAndTheCoincidence) {
  const Scene scene = smooth_scene(17);
  std::vector<Matrix> answers;
  for (const Formulation formulation : formulations()) {
    const auto integrator =
        make_formulation(formulation, *scene.flow, radau_iia(), {}, ProductBackend::openblas);
    answers.push_back(integrated(*integrator, scene.initial, 0.1, 50));
    EXPECT_GE(spectrum_error(answers.back(), scene.initial), 1e-7) << name(formulation);
  }
  EXPECT_GE(largest_difference(answers[1], answers[2]), 1e-7);
  // cotangent and group share one tableau for Q and P, so that P_i = W0 J Q_i J^-1 whatever it is:
  // these two need no symplecticity to coincide.
  EXPECT_LE(largest_difference(answers[0], answers[1]), 1e-11);
}

TEST(GaussAppliedToW, KeepsTheSecondCasimirAndLosesTheThird) {
  const Scene scene = smooth_scene(17);
  for (const int s : {1, 2, 3}) {
    const auto direct =
        made(integrator_entry("direct" + std::to_string(s)), *scene.flow, {.tolerance = 1e-14});
    const Matrix W = integrated(*direct, scene.initial, 0.5, 10);
    EXPECT_LE(std::abs(casimir(W, 2) - casimir(scene.initial, 2)), 1e-12) << s;
    EXPECT_GE(std::abs(casimir(W, 3) - casimir(scene.initial, 3)), 1e-9) << s;
    EXPECT_EQ(skew_defect(W), 0.0);
  }
}

TEST(SkippingTheTrace, GivesAnotherAnswerThatAllThreeAgreeOn) {
  // A Poisson solve that forgets that stage values are not trace-free, and just pins the last
  // unknown of the singular diagonal: only the reference sees it.
  constexpr Index n = 17;
  const Scene scene = smooth_scene(n);
  RealMatrix minus_laplacian = Laplacian::diagonal(n, 0).asDiagonal();
  minus_laplacian.diagonal(1) = minus_laplacian.diagonal(-1) = Laplacian::off_diagonal(n, 0);
  RealVector from_trace = RealVector::Zero(n);
  from_trace.head(n - 1) =
      -minus_laplacian.topLeftCorner(n - 1, n - 1).ldlt().solve(RealVector::Ones(n - 1));
  from_trace /= hbar(HbarConvention::paper, n);
  const FlowOf flow(scene.flow->algebra(), [&](const Matrix& W, Matrix& B) {
    scene.flow->generator(W, B);
    B.diagonal() += W.trace() / static_cast<double>(n) * from_trace;
  });
  const Matrix group = integrated(*gauss(Formulation::group, flow, 2), scene.initial, 0.1, 50);
  const Matrix algebra = integrated(*gauss(Formulation::algebra, flow, 2), scene.initial, 0.1, 50);
  EXPECT_LE(largest_difference(group, algebra), 1e-11);
  EXPECT_GE(largest_difference(group, read_reference("W_t5_h0.1_n17_s2.csv", 17)), 1e-7);
}

}  // namespace
}  // namespace isosyrk::testing
