// What must fail, fails: a tableau that is not symplectic, Gauss applied to W, a trace that is left
// in.  The misprints: tests/scripts/test_theorem.py.
#include <Eigen/Dense>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

TEST(NonSymplecticTableau, LosesTheSpectrumAndTheCoincidence) {
  const Scene scene = smooth_scene(17);
  std::vector<Matrix> answers;
  for (const Formulation formulation : formulations()) {
    const auto integrator =
        make_formulation(formulation, scene.flow, radau_iia(), {}, ProductBackend::openblas);
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
