// The paper's theorem on every quadratic algebra: each scene in all three formulations, in the
// arithmetic that it needs; exact solutions and conserved quantities of single scenes.
#include <fmt/format.h>

#include "isosyrk/catalogue/make_integrator.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

class EachScene : public ::testing::TestWithParam<SceneCase> {
 protected:
  const Scene scene = scene_by_name(GetParam().name, GetParam().parameters);
  const QuadraticAlgebra& algebra = scene.flow->algebra();

  // The step at which h‖B(W₀)‖₂ has this value.
  double step(double h_norm_B) const { return h_norm_B / generator_norm(scene); }
};

INSTANTIATE_TEST_SUITE_P(List, EachScene, ::testing::ValuesIn(tested_scenes()),
                         ::testing::PrintToStringParamName());

TEST(EachSceneOfTheList, IsTestedHere) {
  std::vector<std::string> tested;
  for (const SceneCase& scene : tested_scenes()) tested.push_back(scene.name);
  EXPECT_EQ(scene_names(), tested);
}

TEST_P(EachScene, IsOneMapInAllFormulationsAndStaysOnItsOrbit) {
  constexpr long steps = 10;
  for (const int s : {1, 2, 3, 4, 8}) {
    for (const double h_norm_B : {0.05, 0.2, 0.5}) {
      Matrix first;
      for (const Formulation formulation : formulations()) {
        const auto integrator = gauss(formulation, *scene.flow, s);
        Matrix W = scene.initial;
        const RunReport report = run(*integrator, W, step(h_norm_B), steps);
        ASSERT_TRUE(report.converged()) << name(formulation) << s << " " << h_norm_B;
        // Each form is within tolerance / (1 - contraction) a step of the exact stages; orbits that
        // are not compact, and later steps, may amplify this: 10.
        const double bound = 10.0 * steps * 1e-13 / (1.0 - std::min(0.9, report.contraction));
        if (first.size() == 0) first = W;
        EXPECT_LE(largest_difference(W, first), bound) << name(formulation) << s << " " << h_norm_B;
        EXPECT_LE(algebra.algebra_defect(W), bound);
        for (int k = 2; k <= 5; ++k) {
          const double size = std::pow(scene.initial.norm(), k);
          EXPECT_LE(std::abs(casimir(W, k) - casimir(scene.initial, k)), k * size * bound) << k;
        }
        EXPECT_LE(spectrum_error(algebra, W, scene.initial), 10.0 * bound);
        EXPECT_GE(largest_difference(W, scene.initial), 1e-3);  // it moved
      }
    }
  }
}

TEST_P(EachScene, IsSolvedToOrderTwiceTheStages) {
  const double time = 8.0 * step(0.5);
  const auto exact = gauss(Formulation::group, *scene.flow, 6, 1e-15);
  const Matrix end = integrated(*exact, scene.initial, time / 64.0, 64);
  for (int s = 1; s <= 4; ++s) {
    const auto integrator = gauss(Formulation::algebra, *scene.flow, s, 1e-15);
    const auto error = [&](double h, long count) {
      return largest_difference(integrated(*integrator, scene.initial, h, count), end);
    };
    const double order = observed_order(time, {8, 10, 12, 14, 16, 20, 24, 32, 40, 48}, error,
                                        [](long) { return 1e-13; });  // rounding
    EXPECT_NEAR(order, 2.0 * s, 0.25) << s;
  }
}

TEST_P(EachScene, KeepsItsEnergyToTheOrderOfTheMethodAndIsTheFlowOfItsHamiltonian) {
  ConservationWatch watch(scene);
  const auto integrator = gauss(Formulation::algebra, *scene.flow, 4);
  Matrix W = scene.initial;
  run(*integrator, W, step(0.1), 100,
      [&](long, const Matrix& V, const StepReport&) { watch.observe(V); });
  EXPECT_LE(watch.report(W).energy_error, 1e-10);
  EXPECT_NEAR(integrator->energy(), scene.flow->energy(W), 1e-14 * std::abs(scene.flow->energy(W)));
}

TEST_P(EachScene, HasAFastFormIfAndOnlyIfItsGeneratorIsInSplitStorage) {
  const auto make = [&] { make_integrator(scene.flow, "group2", {.solver = Solver::fast}); };
  if (is_euler_zeitlin(scene.name)) {
    EXPECT_NO_THROW(make());
  } else {
    expect_refused(make, "no generator in split storage");
  }
}

// The same flow in dense complex arithmetic.  Its B reads only what storage would hold.
class DenseFlow final : public Flow {
 public:
  explicit DenseFlow(const Scene& scene)
      : Flow(QuadraticAlgebra::skew_hermitian(scene.flow->size())), scene_(scene) {}
  void generator(const Matrix& W, Matrix& B) const override {
    const Index b = scene_.flow->algebra().block();
    Matrix inside = Matrix::Zero(size(), size());
    for (Index at = 0; at < size(); at += b) inside.block(at, at, b, b) = W.block(at, at, b, b);
    if (b == size()) inside = inside.real().cast<Complex>();
    B = scene_.flow->dense_generator(inside);
  }
  double hamiltonian(const Matrix&) const override { return 0.0; }
  bool has_self_adjoint_generator() const override {
    return scene_.flow->has_self_adjoint_generator();
  }

 private:
  const Scene& scene_;
};

TEST(RealAndBlockArithmetic, GivesTheAnswerOfDenseComplexArithmeticAndKeepsZerosExactly) {
  for (const auto& [name, n] : {std::pair("rigid_body", 7), {"spin_chain", 8}}) {
    const Scene scene = scene_by_name(name, n);
    const DenseFlow dense(scene);
    for (const char* integrator :
         {"cotangent2", "group3", "algebra1", "algebra2", "yoshida4_group", "kahan_li6", "rkmk4",
          "direct2", "rk4", "algebra2_two_products", "elp2", "elp6", "magnus5", "rk4_projected"}) {
      const auto here = make_integrator(scene.flow, integrator);
      const auto there = make_integrator(lent(dense), integrator);
      const Matrix W = integrated(*here, scene.initial, 0.2, 20);
      EXPECT_LE(largest_difference(W, integrated(*there, scene.initial, 0.2, 20)), 2e-12)
          << name << " " << integrator;
      EXPECT_NO_THROW(require_initial_data(*scene.flow, W)) << integrator;
    }
    // Storage has no place for the rest.
    Matrix W = scene.initial;
    W(0, n - 1) += Complex(0.0, 1e-14);
    W(n - 1, 0) += Complex(0.0, 1e-14);
    const Matrix before = W;
    expect_refused([&] { make_integrator(scene.flow, "group2")->step(W, 0.1); }, "entry (0, ");
    EXPECT_EQ(W, before);
    expect_refused([&] { require_initial_data(*scene.flow, W); }, "initial data: W: entry (0, ");
  }
}

// sn, cn and dn of Jacobi by descending Landen transformations, for a modulus k < 1.
// Source: Abramowitz and Stegun, 16.4.
std::array<double, 3> jacobi(double u, double k) {
  std::vector<double> a = {1.0}, c = {k};
  double b = std::sqrt(1.0 - k * k);
  while (std::abs(c.back()) > 1e-17) {
    const double last = a.back();
    a.push_back(0.5 * (last + b));
    c.push_back(0.5 * (last - b));
    b = std::sqrt(last * b);
  }
  double phi = std::ldexp(a.back() * u, static_cast<int>(a.size()) - 1);
  for (std::size_t i = a.size() - 1; i > 0; --i) {
    phi = 0.5 * (phi + std::asin(c[i] / a[i] * std::sin(phi)));
  }
  return {std::sin(phi), std::cos(phi), std::sqrt(1.0 - std::pow(k * std::sin(phi), 2))};
}

// m' = ω × m with ω_k = m_k / I_k, I_0 > I_1 > I_2: that of the top, m' = m × ω, with time
// reversed. Source: Landau and Lifshitz, Mechanics, section 37.  With M² = |m|², 2E = Σ m_k² / I_k
// and M² < 2E I_1, m_2 never vanishes.
class ExactTop {
 public:
  ExactTop(const std::array<double, 3>& m, const std::array<double, 3>& I)
      : sign_(std::copysign(1.0, m[2])) {
    const double M2 = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
    const double E2 = m[0] * m[0] / I[0] + m[1] * m[1] / I[1] + m[2] * m[2] / I[2];
    EXPECT_LT(M2, E2 * I[1]);
    amplitude_ = {std::sqrt(I[0] * (M2 - E2 * I[2]) / (I[0] - I[2])),
                  std::sqrt(I[1] * (M2 - E2 * I[2]) / (I[1] - I[2])),
                  std::sqrt(I[2] * (E2 * I[0] - M2) / (I[0] - I[2]))};
    rate_ = std::sqrt((I[1] - I[2]) * (E2 * I[0] - M2) / (I[0] * I[1] * I[2]));
    k_ = std::sqrt((I[0] - I[1]) * (M2 - E2 * I[2]) / ((I[1] - I[2]) * (E2 * I[0] - M2)));
    // m_0 = a_0 cn τ, m_1 = ± a_1 sn τ, m_2 = ± a_2 dn τ; the phase at time 0 by bisection of sn.
    const double wanted = m[1] / amplitude_[1];
    double low = -1.0, high = 1.0;
    while (jacobi(high, k_)[1] > 0.0) high *= 1.1;
    low = -high;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      (jacobi(middle, k_)[0] < wanted ? low : high) = middle;
    }
    phase_ = low;
    EXPECT_GT(m[0], 0.0);  // the branch on which cn > 0
  }

  std::array<double, 3> at(double t) const {
    // d/dt m_1 = ω_2 m_0 - ω_0 m_2 = m_0 m_2 (1/I_2 - 1/I_0): the sign of m_2 at m_0 > 0.
    const auto [sn, cn, dn] = jacobi(phase_ + sign_ * rate_ * t, k_);
    return {amplitude_[0] * cn, amplitude_[1] * sn, sign_ * amplitude_[2] * dn};
  }

 private:
  double sign_;
  std::array<double, 3> amplitude_{};
  double rate_, k_, phase_;
};

TEST(EulerTop, FollowsItsExactSolutionToTheOrderDownTo1em12) {
  const Scene scene = scene_by_name("euler_top", 3);
  const std::array<double, 3> inertia = {3.0, 2.5, 1.5};
  const auto momentum = [](const Matrix& W) {
    return std::array{W(2, 1).real(), W(0, 2).real(), W(1, 0).real()};
  };
  const ExactTop exact(momentum(scene.initial), inertia);
  const auto error_of = [&](const Matrix& W, double t) {
    double error = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      error = std::max(error, std::abs(momentum(W)[k] - exact.at(t)[k]));
    }
    return error;
  };
  EXPECT_LE(error_of(scene.initial, 0.0), 1e-14);
  const double T = 20.0;
  for (const Formulation formulation : formulations()) {
    for (int s = 1; s <= 4; ++s) {
      const auto top = gauss(formulation, *scene.flow, s, 1e-15);
      const auto error = [&](double h, long count) {
        return error_of(integrated(*top, scene.initial, h, count), T);
      };
      const double order = observed_order(T, {12, 16, 24, 32, 48, 64, 96, 128, 192}, error,
                                          [](long) { return 1e-12; });
      EXPECT_NEAR(order, 2.0 * s, 0.25) << name(formulation) << s;
    }
  }
  const auto fine = gauss(Formulation::group, *scene.flow, 4, 1e-15);
  EXPECT_LE(error_of(integrated(*fine, scene.initial, T / 400.0, 400), T), 1e-12);
  EXPECT_GE(error_of(scene.initial, T), 0.1);  // it turned
}

TEST(SpinChain, KeepsItsTotalSpinAndItsEnergyWithoutDriftOver10000Steps) {
  const Index n = 16;
  const Scene scene = scene_by_name("spin_chain", n);
  const auto total_spin = [&](const Matrix& W) {
    Matrix sum = Matrix::Zero(2, 2);
    for (Index k = 0; k < n; k += 2) sum += W.block(k, k, 2, 2);
    return sum;
  };
  const auto energies_of = [&](const std::string& integrator) {
    std::vector<double> energies;
    Matrix W = scene.initial;
    const auto method = make_integrator(scene.flow, integrator);
    const RunReport report = run_while(*method, W, 0.2, 10000, [&](const RunReport&) {
      energies.push_back(method->energy() / scene.flow->energy(scene.initial) - 1.0);
      return true;
    });
    EXPECT_TRUE(report.converged());
    return std::pair(energies, largest_difference(total_spin(W), total_spin(scene.initial)));
  };
  // Means over the first and the last fifth of the run, and the largest error of each.
  const auto fifth = [](const std::vector<double>& energies, std::size_t k) {
    return Eigen::Map<const RealVector>(energies.data() + 2000 * k, 2000);
  };
  for (const char* integrator : {"algebra1", "group2"}) {
    const auto [energies, change_of_spin] = energies_of(integrator);
    EXPECT_LE(change_of_spin, 1e-9) << integrator;  // 10 000 steps of tolerance 1e-13
    const auto first = fifth(energies, 0), last = fifth(energies, 4);
    const double bound = first.cwiseAbs().maxCoeff();
    EXPECT_LE(bound, 1e-2);
    EXPECT_LE(last.cwiseAbs().maxCoeff(), 1.5 * bound) << integrator;
    EXPECT_LE(std::abs(last.mean() - first.mean()), 0.5 * bound) << integrator;
  }
  // The control, isospectral but not Lie-Poisson, loses both.
  const auto [drifting, change_of_spin] = energies_of("rkmk4");
  EXPECT_GE(change_of_spin, 1e-4);
  EXPECT_GE(std::abs(fifth(drifting, 4).mean() - fifth(drifting, 0).mean()),
            3.0 * fifth(drifting, 0).cwiseAbs().maxCoeff());
}

TEST(SpinChain, HoldsAndReadsAsManyNumbersAsItHasSpins) {
  const Scene scene = scene_by_name("spin_chain", 64);
  EXPECT_EQ(scene.flow->algebra().zero<Complex>().size(), 128);
}

// Every published and fast form is a Poisson map of so(3), su(3), sp(2) and su(1,1).
TEST(PoissonMap, OnSmallAlgebrasForPublishedAndFastForms) {
  const Scene top = scene_by_name("euler_top", 3);
  const Scene fluid =
      smooth_scene(3, HbarConvention::paper,
                   {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {2, 0, 0.7}});
  const ConjugationFlow sp2(QuadraticAlgebra(symplectic_J(1)), 3);
  const ConjugationFlow su11(QuadraticAlgebra(indefinite_J(1, 1)), 4);
  struct Case {
    const Flow& flow;
    Matrix W0;
  };
  const double h = 1.0;
  const std::vector<Case> cases = {{*top.flow, top.initial},
                                   {*fluid.flow, fluid.initial},
                                   {sp2, sp2.element(5)},
                                   {su11, su11.element(6)}};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const auto& [flow, W0] = cases[c];
    for (const auto& [formulation, s] : methods(3)) {
      EXPECT_LE(poisson_map_defect(*gauss(formulation, flow, s, 1e-15), W0, h), 1e-10)
          << c << name(formulation) << s;
      if (&flow != fluid.flow.get()) continue;
      const auto fast =
          make_integrator(lent(flow), fmt::format("{}{}", name(formulation), s),
                          {.solver = Solver::fast, .iteration = {.tolerance = 1e-15}});
      EXPECT_LE(poisson_map_defect(*fast, W0, h), 1e-10) << "fast " << name(formulation) << s;
    }
    // The control keeps the spectrum and is no Poisson map.
    EXPECT_GE(poisson_map_defect(*make_integrator(lent(flow), "rkmk4"), W0, h), 1e-7) << c;
  }
}

}  // namespace
}  // namespace isosyrk::testing
