// The exponential Lie-Poisson methods, those of Bogfjellmo and Marthinsen, Magnus methods and
// Runge-Kutta methods with a projection: what they keep in every scene that takes them, and what
// they refuse.
#include <fmt/format.h>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/catalogue/make_integrator.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/linalg/adjoint_rotation.h"
#include "isosyrk/linalg/spectral_projection.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

const std::vector<std::string> names = {"elp2",    "elp4",          "elp6",         "bm1",
                                        "bm2",     "bm3",           "cg4",          "magnus4",
                                        "magnus5", "rk4_projected", "rk5_projected"};

struct Case {
  std::string scene;
  SceneParameters parameters;
  std::string integrator;
};

void PrintTo(const Case& tested, std::ostream* out) {
  *out << tested.scene << "_" << tested.integrator;
}

// Every method in every scene that takes it, in the frame too where there is one.
std::vector<Case> cases() {
  std::vector<Case> found;
  for (const auto& [scene, parameters] : tested_scenes()) {
    const SharedFlow flow = scene_by_name(scene, parameters).flow;
    for (const IntegratorEntry& entry : integrators()) {
      const bool is_one = std::find(names.begin(), names.end(), entry.method()) != names.end();
      if (is_one && takes(entry, *flow)) found.push_back({scene, parameters, entry.name});
    }
  }
  return found;
}

class InEachScene : public ::testing::TestWithParam<Case> {
 protected:
  const Scene scene = scene_by_name(GetParam().scene, GetParam().parameters);
  const IntegratorEntry& entry = integrator_entry(GetParam().integrator);

  std::unique_ptr<Integrator> method(double tolerance = 1e-13) const {
    return made(entry, *scene.flow, {.tolerance = tolerance});
  }
  // The step at which h‖B(W₀)‖₂ has this value.
  double step(double h_norm_B) const { return h_norm_B / generator_norm(scene); }
};

INSTANTIATE_TEST_SUITE_P(List, InEachScene, ::testing::ValuesIn(cases()),
                         ::testing::PrintToStringParamName());

TEST(ScenesOfExponentialMethods, AreAllScenes) {
  std::vector<std::string> tested;
  for (const auto& [scene, parameters] : tested_scenes()) tested.push_back(scene);
  EXPECT_EQ(scene_names(), tested);
  EXPECT_EQ(cases().size(), 5 * names.size() + 2 * names.size());
}

// The error is that of the states at four times together: at a single one, terms of different
// orders may cancel.
TEST_P(InEachScene, HasItsOrderToATenth) {
  constexpr long parts = 4;
  const double time = 8.0 * step(0.5);
  const auto states = [&](Integrator& integrator, long steps_of_part) {
    std::vector<Matrix> found;
    Matrix W = scene.initial;
    for (long part = 0; part < parts; ++part) {
      W = integrated(integrator, W, time / static_cast<double>(parts * steps_of_part),
                     steps_of_part);
      found.push_back(W);
    }
    return found;
  };
  const std::vector<Matrix> exact = states(*gauss(Formulation::group, *scene.flow, 6, 1e-15), 16);
  const auto precise = method(1e-15);
  const auto error = [&](double, long count) {
    const std::vector<Matrix> found = states(*precise, count / parts);
    double sum = 0.0;
    for (std::size_t k = 0; k < exact.size(); ++k) sum += (found[k] - exact[k]).squaredNorm();
    return std::sqrt(sum);
  };
  // Rounding, of both.
  const auto plateau = [](long) { return 1e-12; };
  const double order =
      observed_order(time, {8, 12, 16, 20, 24, 32, 40, 48, 64, 96, 128, 192, 256}, error, plateau);
  EXPECT_GE(order, entry.order - 0.1);
  // In these the term of the order shows only where rounding begins: the next one is larger.
  for (const char* hidden : {"spin_chain_magnus4", "rigid_body_magnus5", "euler_top_magnus5",
                             "spin_chain_rk5_projected"}) {
    if (::testing::PrintToString(GetParam()) == hidden) return;
  }
  EXPECT_LE(order, entry.order + 0.1);
}

TEST_P(InEachScene, KeepsTheSpectrumToRoundingInLongRunsAtAnyTolerance) {
  constexpr long steps = 2000;
  for (const double tolerance : {1e-13, 1e-3}) {
    const Matrix W = integrated(*method(tolerance), scene.initial, step(0.2), steps);
    EXPECT_LE(spectrum_error(scene.flow->algebra(), W, scene.initial), 1e-13) << tolerance;
    EXPECT_EQ(scene.flow->algebra().algebra_defect(W), 0.0);
    EXPECT_GE(largest_difference(W, scene.initial), 1e-2);
  }
}

TEST_P(InEachScene, IsSymmetricIfAndOnlyIfItSaysSo) {
  const auto there_and_back = method(1e-15);
  Matrix W = scene.initial;
  there_and_back->step(W, step(0.5));
  there_and_back->step(W, -step(0.5));
  const double error = largest_difference(W, scene.initial);
  if (entry.keeps.symmetric) {
    EXPECT_LE(error, 1e-14);
  } else {
    EXPECT_GE(error, 1e-12);
  }
}

// What a Lie-Poisson method keeps of a symmetry: the angular momentum of Euler-Zeitlin, the total
// spin of the chain.  One that is not Lie-Poisson loses it with the error of its steps.
TEST_P(InEachScene, KeepsTheMomentumIfAndOnlyIfItIsLiePoisson) {
  constexpr Index n = 10;  // of the spin chain
  const auto momentum = [&](const Matrix& W) {
    Matrix sum = Matrix::Zero(2, 2);
    for (Index k = 0; k < n; k += 2) sum += W.block(k, k, 2, 2);
    return sum;
  };
  if (!is_euler_zeitlin(GetParam().scene) && GetParam().scene != "spin_chain") return;
  const Matrix W = integrated(*method(), scene.initial, step(0.5), 100);
  const double error = GetParam().scene == "spin_chain"
                           ? largest_difference(momentum(W), momentum(scene.initial))
                           : angular_momentum_error(W, scene.initial);
  if (entry.keeps.lie_poisson) {
    EXPECT_LE(error, 1e-11);  // 100 steps of tolerance 1e-13
  } else {
    EXPECT_GE(error, 1e-8);
  }
}

TEST_P(InEachScene, SaysThatItDivergesWhereTheStepIsFarTooLongAndKeepsTheState) {
  const auto diverging = method();
  diverging->set_state(scene.initial);
  const Matrix before = diverging->state();
  const StepReport report = diverging->step(step(200.0));
  EXPECT_EQ(report.status, Status::diverged) << report.sweeps;
  EXPECT_EQ(diverging->state(), before);
}

// A Gauss method is isospectral only as far as its stage equations are solved.
TEST(ControlOfTheSpectrum, GaussLosesItAtALooseTolerance) {
  const Scene scene = smooth_scene(9);
  const auto loose = gauss(Formulation::group, *scene.flow, 2, 1e-3);
  const Matrix W = integrated(*loose, scene.initial, 0.2 / generator_norm(scene), 100);
  EXPECT_GE(spectrum_error(W, scene.initial), 1e-6);
}

TEST(ExponentialLiePoisson, TakesMoreSweepsForATighterToleranceAndEndsAtTheCap) {
  const Scene scene = smooth_scene(9);
  const IntegratorEntry& entry = integrator_entry("elp4");
  const auto sweeps = [&](double tolerance) {
    Matrix W = scene.initial;
    const StepReport report = made(entry, *scene.flow, {.tolerance = tolerance})->step(W, 0.5);
    EXPECT_EQ(report.status, Status::converged);
    EXPECT_LT(report.last_change, tolerance);
    return report.sweeps;
  };
  EXPECT_LT(sweeps(1e-4), sweeps(1e-8));
  EXPECT_LT(sweeps(1e-8), sweeps(1e-12));
  Matrix W = scene.initial;
  const StepReport capped = made(entry, *scene.flow, {1e-13, 3})->step(W, 0.5);
  EXPECT_EQ(capped.status, Status::sweep_cap);
  EXPECT_EQ(capped.sweeps, 3);
  EXPECT_EQ(W, scene.initial);
}

// Tolerances are relative to Ω: so are the errors that they leave, for short steps as for long
// ones.
TEST(ExponentialLiePoisson, ToleranceIsRelativeToOmega) {
  const Scene scene = smooth_scene(9);
  for (const double h : {1e-6, 1e-3, 0.3}) {
    Matrix W = scene.initial, exact = scene.initial;
    made(integrator_entry("elp2"), *scene.flow, {.tolerance = 1e-6})->step(W, h);
    made(integrator_entry("elp2"), *scene.flow, {.tolerance = 1e-15})->step(exact, h);
    EXPECT_LE((W - exact).norm(), 1e-5 * (exact - scene.initial).norm()) << h;
  }
  // h = 0 and a state of rest need no Ω at all.
  Matrix W = scene.initial;
  EXPECT_EQ(made(integrator_entry("elp6"), *scene.flow)->step(W, 0.0).status, Status::converged);
  EXPECT_EQ(W, scene.initial);
  W.setZero();
  EXPECT_EQ(made(integrator_entry("elp6"), *scene.flow)->step(W, 1.0).status, Status::converged);
  EXPECT_EQ(W, Matrix::Zero(9, 9));
}

TEST(ExponentialLiePoisson, TakesTheProductsAndSolvesThatItsHeaderSays) {
  const Scene scene = smooth_scene(9);
  struct Work {
    const char* name;
    long brackets, solves;
  };
  // The series of the first sweep, with Ω = 0, has one term.
  for (const Work& of : {Work{"elp2", 0, 1}, {"elp4", 3, 3}, {"elp6", 12, 6}}) {
    Matrix W = scene.initial;
    const auto one_sweep = made(integrator_entry(of.name), *scene.flow, {1e-13, 1});
    const StepReport report = one_sweep->step(W, 0.1);
    EXPECT_EQ(report.work.products, of.brackets + 1) << of.name;
    EXPECT_EQ(report.work.poisson_solves, of.solves) << of.name;
  }
  for (const auto& [name, products, solves] :
       {std::tuple{"magnus4", 6, 7}, {"magnus5", 12, 12}, {"rk4_projected", 7, 4}}) {
    Matrix W = scene.initial;
    const StepReport report = made(integrator_entry(name), *scene.flow)->step(W, 0.0);
    const int of_series = name[0] == 'm' ? 1 : 0;  // Ω = 0
    EXPECT_EQ(report.work.products, products + of_series) << name;
    EXPECT_EQ(report.work.poisson_solves, solves) << name;
  }
}

// Energies of two thousand steps: means over the first and the last fifth.  Rounding decides which
// part of its orbit a state shows in the last fifth.  Starts that lie 1e-15 apart, four for each
// method, give 0.001 to 0.56 of the largest error of the first fifth where there is no drift,
// and 3.9 to 7.3 where there is.
TEST(ExponentialLiePoisson, HasNoDriftOfTheEnergyAndMagnusHas) {
  const Scene scene = smooth_scene(9);
  const double energy = scene.flow->energy(scene.initial);
  const auto drift_and_bound = [&](const char* name) {
    RealVector errors(2000);
    Index k = 0;
    Matrix W = scene.initial;
    const auto method = make_integrator(scene.flow, name);
    const RunReport report = run_while(*method, W, 0.5, 2000, [&](const RunReport&) {
      errors(k++) = method->energy() / energy - 1.0;
      return true;
    });
    EXPECT_TRUE(report.converged());
    const double drift = std::abs(errors.tail(400).mean() - errors.head(400).mean());
    return std::pair(drift, errors.head(400).cwiseAbs().maxCoeff());
  };
  for (const char* name : {"elp2", "elp4", "elp6"}) {
    const auto [drift, bound] = drift_and_bound(name);
    EXPECT_LE(drift, bound) << name;
    EXPECT_LE(bound, 1e-2) << name;
  }
  for (const char* name : {"magnus4", "magnus5", "rk4_projected"}) {
    const auto [drift, bound] = drift_and_bound(name);
    EXPECT_GE(drift, 2.0 * bound) << name;
  }
}

// Relative Frobenius distance to a reference at T = 5, as in the accuracy study.  The figures were
// found by another implementation.
TEST(ExponentialLiePoisson, LargeNErrorsAreThoseThatWereFoundBefore) {
  const Scene scene = smooth_scene(65);
  const Matrix exact =
      integrated(*made(fast_entry("group8_frame"), *scene.flow, {.tolerance = 1e-15}),
                 scene.initial, 0.05, 100);
  for (const auto& [name, expected] :
       {std::pair{"elp2", 1.4e-3}, {"elp4", 8.4e-6}, {"elp6", 7.4e-8}}) {
    const Matrix W = integrated(*make_integrator(scene.flow, name), scene.initial, 0.5, 10);
    EXPECT_NEAR((W - exact).norm() / exact.norm(), expected, 0.2 * expected) << name;
    EXPECT_LE(spectrum_error(W, scene.initial), 1e-13);
  }
}

TEST(Requirements, AreToldInOneLine) {
  for (const auto& [scene, parameters] : tested_scenes()) {
    const SharedFlow flow = scene_by_name(scene, parameters).flow;
    for (const IntegratorEntry& entry : integrators()) {
      if (entry.co_rotating || takes(entry, *flow)) continue;
      expect_refused([&] { make_integrator(flow, entry.name); },
                     entry.name + ": for flows of skew-Hermitian matrices");
    }
  }
  const QuadraticAlgebra algebra = QuadraticAlgebra::skew_hermitian(4);
  const FlowOf any(algebra, [](const Matrix& W, Matrix& B) { B = W; });
  for (const char* name : {"elp4", "elp6"}) {
    expect_refused([&] { make_integrator(lent(any), name); }, "not known to be linear");
  }
  for (const char* name : {"elp2", "magnus4", "magnus5", "rk4_projected"}) {
    EXPECT_NO_THROW(make_integrator(lent(any), name));
  }
}

TEST(SelfAdjointGenerators, AreLinearAndSelfAdjoint) {
  const auto element = [](const Flow& flow, unsigned seed) {
    const Index b = flow.algebra().block();
    Matrix X = entries_of(random_matrix(flow.size(), seed),
                          [b](Index r, Index c) { return r / b == c / b; });
    if (dynamic_cast<const RealFlow*>(&flow) != nullptr) X = Matrix(X.real().cast<Complex>());
    Matrix mirrored = X.adjoint();
    if (flow.algebra().is_dense()) flow.algebra().involution(X, mirrored);
    return Matrix(X - mirrored);
  };
  const auto pairing = [](const Matrix& X, const Matrix& Y) {
    return -X.cwiseProduct(Y.transpose()).sum().real();
  };
  const auto defect = [&](const Flow& flow) {
    const Matrix A = element(flow, 1), C = element(flow, 2);
    const Matrix BA = flow.dense_generator(A), BC = flow.dense_generator(C);
    return (flow.dense_generator(0.6 * A - 0.8 * C) - (0.6 * BA - 0.8 * BC)).norm() / BA.norm() +
           std::abs(pairing(A, BC) - pairing(BA, C)) / (A.norm() * BC.norm());
  };
  for (const auto& [name, parameters] : tested_scenes()) {
    const Scene scene = scene_by_name(name, parameters);
    EXPECT_TRUE(scene.flow->has_self_adjoint_generator()) << name;
    EXPECT_LE(defect(*scene.flow), 1e-13) << name;
  }
  const FlowOf toda(QuadraticAlgebra::skew_hermitian(5), [](const Matrix& W, Matrix& B) {
    B = Complex(0.0, 1.0) * W;
    B.triangularView<Eigen::StrictlyLower>() = -B.adjoint();
    B.diagonal().setZero();
  });
  EXPECT_GE(defect(toda), 1e-2);
  EXPECT_FALSE(toda.has_self_adjoint_generator());
}

// The derivative of this B along the flow is not B of the derivative of W.
TEST(ExplicitMagnus, HasItsOrderForAGeneratorThatIsNotLinear) {
  constexpr Index n = 5;
  const FlowOf flow(QuadraticAlgebra::skew_hermitian(n), [](const Matrix& W, Matrix& B) {
    Matrix D = Matrix::Zero(n, n);
    D.diagonal() << 0.5, 0.9, 0.4, 1.7, 0.3;
    B = product({D, W, D}) - product({W, D, W, D, W});
  });
  const Matrix W0 = random_skew_hermitian(n, 3);
  const double time = 2.0;
  const Matrix exact =
      integrated(*gauss(Formulation::group, flow, 6, 1e-15), W0, time / 100.0, 100);
  ASSERT_GE(largest_difference(exact, W0), 0.05);
  for (const auto& [name, order] : {std::pair{"magnus4", 4.0}, {"magnus5", 5.0}}) {
    const auto method = made(integrator_entry(name), flow);
    const auto error = [&](double h, long count) {
      return largest_difference(integrated(*method, W0, h, count), exact);
    };
    const auto plateau = [](long) { return 1e-12; };
    EXPECT_NEAR(observed_order(time, {8, 12, 16, 24, 32, 48, 64, 96}, error, plateau), order, 0.15)
        << name;
  }
  // Taken for linear, B has D_i = B([B_i, W_i]), and the order is 2.
  const FlowOf taken_for_linear(
      flow.algebra(), [&](const Matrix& W, Matrix& B) { flow.generator(W, B); }, Generator::linear);
  const auto wrong = made(integrator_entry("magnus4"), taken_for_linear);
  const auto error = [&](double h, long count) {
    return largest_difference(integrated(*wrong, W0, h, count), exact);
  };
  EXPECT_LE(observed_order(time, {8, 12, 16, 24, 32}, error, [](long) { return 1e-12; }), 3.2);
}

// The spectrum of the run is that of the state that was set or amended last; a single step has its
// own.
TEST(ProjectedRungeKutta, KeepsTheSpectrumOfTheStateThatWasSet) {
  const Scene scene = smooth_scene(9);
  const auto method = made(integrator_entry("rk4_projected"), *scene.flow);
  const auto expect_spectrum_of = [&](const Matrix& W) {
    for (int k = 0; k < 20; ++k) ASSERT_EQ(method->step(0.5).status, Status::converged);
    EXPECT_LE(spectrum_error(method->state(), W), 1e-14);
  };
  method->set_state(scene.initial);
  expect_spectrum_of(scene.initial);
  const Matrix amended = 1.01 * method->state() + 0.01 * random_skew_hermitian(9, 1);
  method->amend_state(amended);
  expect_spectrum_of(amended);
  Matrix other = rough_scene(9).initial;
  ASSERT_EQ(method->step(other, 0.5).status, Status::converged);
  EXPECT_LE(spectrum_error(other, rough_scene(9).initial), 1e-14);
  expect_spectrum_of(amended);
  method->set_state(rough_scene(9).initial);
  expect_spectrum_of(rough_scene(9).initial);

  const Matrix lost =
      integrated(*made(integrator_entry("rk4"), *scene.flow), scene.initial, 0.5, 20);
  EXPECT_GE(spectrum_error(lost, scene.initial), 1e-7);
}

TEST(SpectralProjection, IsTheNearestMatrixWithTheSpectrum) {
  for (const auto& [n, b] : {std::pair<Index, Index>{8, 8}, {65, 65}, {8, 2}}) {
    const QuadraticAlgebra algebra = QuadraticAlgebra::skew_hermitian(n, b);
    const auto in_blocks = [size = n, block = b](unsigned seed) {
      return entries_of(random_skew_hermitian(size, seed),
                        [block](Index r, Index c) { return r / block == c / block; });
    };
    SpectralProjection projection(algebra, ProductBackend::openblas);
    const Matrix W0 = in_blocks(1);
    Matrix W = W0 + 1e-3 * in_blocks(2);
    const double distance = (W - W0).norm();
    RealVector eigenvalues(n);
    ASSERT_TRUE(projection.find_spectrum(W0, eigenvalues));
    const Matrix before = W;
    ASSERT_TRUE(projection.project(eigenvalues, W));
    EXPECT_LE(spectrum_error(algebra, W, W0), 1e-14);
    EXPECT_EQ(skew_defect(W), 0.0);
    // W0 has this spectrum too, and is no nearer.
    EXPECT_LE((W - before).norm(), distance);
    EXPECT_GE((W - before).norm(), 1e-6);
    // What has the spectrum stays, and another basis makes no difference.
    Matrix again = W;
    ASSERT_TRUE(projection.project(eigenvalues, again));
    EXPECT_LE(largest_difference(again, W), 2e-14);
    if (b == n) {
      const Matrix U = exponential(random_skew_hermitian(n, 3));
      Matrix turned = product({U, before, U.adjoint()});
      ASSERT_TRUE(projection.project(eigenvalues, turned));
      EXPECT_LE(largest_difference(turned, product({U, W, U.adjoint()})), 1e-13);
    }
    W(0, 0) = std::nan("");
    EXPECT_FALSE(projection.project(eigenvalues, W));
    EXPECT_FALSE(projection.find_spectrum(W, eigenvalues));
    EXPECT_TRUE(std::isnan(eigenvalues(0)));
    Matrix finite = W0;
    EXPECT_FALSE(projection.project(eigenvalues, finite));
  }
}

TEST(AdjointRotation, IsTheExponentialAndItsMean) {
  constexpr Index n = 6;
  for (const QuadraticAlgebra& algebra :
       {QuadraticAlgebra::skew_hermitian(n), QuadraticAlgebra(symplectic_J(3)),
        QuadraticAlgebra(indefinite_J(4, 2))}) {
    const ConjugationFlow elements(algebra, 1);
    const Matrix W = elements.element(2);
    Products products(ProductBackend::openblas, n);
    AdjointSeries<Complex> series(algebra);
    AdjointRotation<Complex> rotation(algebra);
    // From the third size on in several parts.
    for (const double size : {0.0, 1e-3, 1.0, 3.0, 6.0}) {
      const Matrix Omega = size * elements.element(3);
      Matrix rotated = W, mean = W, expected = W;
      ASSERT_TRUE(rotation.rotate(products, Omega, W, rotated, mean));
      const double bound = 1e-14 * std::exp(2.0 * size);  // the group of J need not be compact
      EXPECT_LE(largest_difference(rotated, product({exponential(Omega), W, exponential(-Omega)})),
                bound);
      EXPECT_LE(algebra.algebra_defect(mean), bound);
      ASSERT_TRUE(series.conjugate(products, 1.0, Omega, W, expected));
      EXPECT_LE(largest_difference(rotated, expected), bound);
      // The mean over s by Gauss' rule with 20 nodes.
      const Tableau rule = gauss_tableau(20);
      expected.setZero();
      for (Index k = 0; k < 20; ++k) {
        const Matrix part = rule.c(k) * Omega;
        expected += rule.b(k) * product({exponential(part), W, exponential(-part)});
      }
      EXPECT_LE(largest_difference(mean, expected), bound);
    }
  }
}

// The single series loses digits where its terms cancel, and does not say so.
TEST(AdjointRotation, KeepsTheSpectrumToRoundingForAnyOmegaOrFails) {
  constexpr Index n = 6;
  const QuadraticAlgebra algebra = QuadraticAlgebra::skew_hermitian(n);
  Products products(ProductBackend::openblas, n);
  AdjointSeries<Complex> series(algebra);
  AdjointRotation<Complex> rotation(algebra);
  const Matrix W = random_skew_hermitian(n, 1), unit = random_skew_hermitian(n, 2);
  Matrix out = W, mean = W;
  for (const double size : {1.0, 4.0, 12.0}) {
    const Matrix Omega = size * unit;
    ASSERT_TRUE(rotation.rotate(products, Omega, W, out, mean)) << size;
    EXPECT_LE(spectrum_error(out, W), 5e-14) << size;
    EXPECT_LE(largest_difference(out, W + commutator(Omega, mean)), 1e-13 * size) << size;
    EXPECT_LE(largest_difference(out, product({exponential(Omega), W, exponential(-Omega)})),
              1e-13 * size);
  }
  ASSERT_TRUE(series.conjugate(products, 1.0, 12.0 * unit, W, out));
  EXPECT_GE(spectrum_error(out, W), 1e-8);
  EXPECT_FALSE(rotation.rotate(products, 60.0 * unit, W, out, mean));
  for (const double size : {1e4, 1e200, std::nan("")}) {
    EXPECT_FALSE(rotation.rotate(products, size * unit, W, out, mean)) << size;
    EXPECT_FALSE(series.conjugate(products, 1.0, size * unit, W, out)) << size;
  }
}

}  // namespace
}  // namespace isosyrk::testing
