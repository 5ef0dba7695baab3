// The Lie-Poisson methods of Bogfjellmo and Marthinsen, against another implementation.
#include <fmt/format.h>

#include "isosyrk/integrators/bogfjellmo_marthinsen.h"
#include "isosyrk/simulation/conservation.h"
#include "isosyrk/tableaux/composition_schemes.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// What another implementation does: series cut after the power K, with the adjoint D* or without.
struct Variant {
  int K;
  bool has_adjoint = true;
};

double factorial(int k) { return std::tgamma(k + 1.0); }

// φ(ad_A) X by its series up to the power K.
Matrix series(const Matrix& A, const Matrix& X, int K) {
  Matrix sum = X, power = X;
  for (int k = 1; k <= K; ++k) {
    power = commutator(A, power);
    sum += power / factorial(k + 1);
  }
  return sum;
}

// The equations of core/integrators/BOGFJELLMO_MARTHINSEN.md, term by term.
class ByDefinition final : public PublishedForm<Complex> {
 public:
  ByDefinition(const Flow& flow, int s, Variant variant)
      : PublishedForm(lent(flow), ProductBackend::openblas),
        tableau_(gauss_tableau(s)),
        variant_(variant) {}

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) override {
    const auto [name, order, a, b, c] = tableau_;
    const int s = tableau_.stages(), K = variant_.K;
    const auto B = [&](const Matrix& W) {
      Stored found = zero();
      generator(W, found);
      return Matrix(found);
    };
    std::vector<Matrix> v(static_cast<std::size_t>(s), B(W0)), mu(v.size(), Matrix(W0));
    Matrix Omega;
    double change = 1.0;
    for (int sweep = 0; sweep < 1000 && change > 1e-15; ++sweep) {
      Omega = Matrix::Zero(W0.rows(), W0.cols());
      for (int j = 0; j < s; ++j) Omega += h * b(j) * v[j];
      const Matrix lambda = series(Omega, W0, 40);
      std::vector<Matrix> next_v(v.size()), next_mu(v.size()), D(v.size()), Omegas(v.size());
      for (int i = 0; i < s; ++i) {
        Omegas[i] = Matrix::Zero(W0.rows(), W0.cols());
        for (int j = 0; j < s; ++j) Omegas[i] += h * a(i, j) * v[j];
        D[i] = Matrix::Zero(W0.rows(), W0.cols());
        Matrix of_v = v[i];
        for (int q = 0; q < K; ++q) {
          Matrix of_mu = mu[i];
          for (int p = 0; p + q < K; ++p) {
            D[i] += commutator(of_v, of_mu) / factorial(p + q + 2);
            of_mu = commutator(of_mu, Omegas[i]);
          }
          of_v = commutator(Omegas[i], of_v);
        }
      }
      for (int j = 0; j < s; ++j) {
        next_mu[j] = mu[j] + lambda - series(-Omegas[j], mu[j], K);
        for (int i = 0; i < s && variant_.has_adjoint; ++i) {
          next_mu[j] -= (h / b(j)) * b(i) * a(i, j) * D[i];
        }
      }
      for (int i = 0; i < s; ++i) {
        next_v[i] = v[i] + B(next_mu[i]) - series(Omegas[i], v[i], K);
      }
      change = 0.0;
      for (int i = 0; i < s; ++i) {
        change = larger(change, larger((next_v[i] - v[i]).norm(), (next_mu[i] - mu[i]).norm()));
      }
      v = next_v;
      mu = next_mu;
    }
    const Matrix U = exponential(Omega);
    W1 = product({U, W0, U.adjoint()});
    return {};
  }

  Tableau tableau_;
  Variant variant_;
};

const Scene& small_scene() {
  static const Scene scene = smooth_scene(
      4, HbarConvention::paper,
      {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {3, 2, {-0.6, 0.9}}, {3, 0, 0.7}});
  return scene;
}

// B = ∇H for H(W) = ½ <W, DWD> - ¼ <W, DWDWDWD>: not linear.
FlowOf quartic_flow() {
  return FlowOf(QuadraticAlgebra::skew_hermitian(4), [](const Matrix& W, Matrix& B) {
    Matrix D = Matrix::Zero(4, 4);
    D.diagonal() << 0.5, 0.9, 0.4, 1.3;
    B = product({D, W, D}) - product({D, W, D, W, D, W, D});
  });
}

std::unique_ptr<Integrator> listed(const std::string& name, const Flow& flow) {
  return made(integrator_entry(name), flow, {.tolerance = 1e-15});
}

class Stages : public ::testing::TestWithParam<int> {
 protected:
  const int s = GetParam();
  const std::string name = fmt::format("bm{}", s);
};
INSTANTIATE_TEST_SUITE_P(One, Stages, ::testing::Values(1, 2, 3));

TEST_P(Stages, AreThoseOfAnotherImplementation) {
  const Scene scene = smooth_scene(7);
  for (const double h : {0.3, -0.7}) {
    Matrix W = scene.initial, expected = scene.initial, other = scene.initial;
    ASSERT_EQ(listed(name, *scene.flow)->step(W, h).status, Status::converged);
    ByDefinition(*scene.flow, s, {2 * s - 2}).step(expected, h);
    EXPECT_LE(largest_difference(W, expected), 1e-13);
    ByDefinition(*scene.flow, s, {2 * s}).step(other, h);
    if (s > 1) {
      EXPECT_GE(largest_difference(W, other), 1e-11);
    }
  }
}

TEST_P(Stages, AreAPoissonMapWithTheAdjointOfTheDerivativeAndNoneWithout) {
  const Scene& scene = small_scene();
  const FlowOf quartic = quartic_flow();
  for (const Flow* flow : {scene.flow.get(), static_cast<const Flow*>(&quartic)}) {
    const double h = 0.7;
    EXPECT_LE(poisson_map_defect(*listed(name, *flow), scene.initial, h), 1e-10);
    for (const int K : {1, 5}) {  // any
      ByDefinition complete(*flow, s, {K}), control(*flow, s, {K, false});
      EXPECT_LE(poisson_map_defect(complete, scene.initial, h), 1e-10) << K;
      if (s > 1) {
        EXPECT_GE(poisson_map_defect(control, scene.initial, h), 1e-5) << K;
      }
    }
  }
}

// Two powers fewer than the order needs.
TEST_P(Stages, HaveTheirOrderForABThatIsNotLinearAndALowerOneByAShorterSeries) {
  const FlowOf flow = quartic_flow();
  const Matrix W0 = small_scene().initial;
  const double time = 4.0;
  const Matrix exact = integrated(*gauss(Formulation::group, flow, 6, 1e-15), W0, time / 40.0, 40);
  const auto order = [&](Integrator& integrator) {
    const auto error = [&](double h, long count) {
      return largest_difference(integrated(integrator, W0, h, count), exact);
    };
    return observed_order(time, {6, 8, 10, 12, 16, 20, 24, 32}, error, [](long) { return 1e-12; });
  };
  EXPECT_NEAR(order(*listed(name, flow)), 2 * s, 0.2);
  if (s > 1) {
    ByDefinition shorter(flow, s, {2 * s - 4});
    EXPECT_NEAR(order(shorter), 2 * s - 2, 0.3);
  }
}

TEST_P(Stages, TakeTheProductsAndSolvesOfTheirHeader) {
  const Scene scene = smooth_scene(9);
  Matrix W = scene.initial;
  const auto entry = integrator_entry(name);
  // The series of λ is the same in a method of one stage: B(W₀) for all v.
  const auto of_sweep = [&](const std::string& method) {
    Matrix X = scene.initial;
    return made(integrator_entry(method), *scene.flow, {1e-13, 1})->step(X, 0.1).work;
  };
  EXPECT_EQ(of_sweep(name).products - of_sweep("bm1").products, 3 * (2 * s - 2) * s);
  EXPECT_EQ(of_sweep(name).poisson_solves, s + 1);
}

TEST(BogfjellmoMarthinsen, WithOneStageIsTheExponentialMethodOfOrderTwo) {
  for (const auto& [scene_name, parameters] : tested_scenes()) {
    const Scene scene = scene_by_name(scene_name, parameters);
    if (!takes(integrator_entry("bm1"), *scene.flow)) continue;
    const double h = 0.5 / generator_norm(scene);
    const Matrix expected = integrated(*listed("elp2", *scene.flow), scene.initial, h, 10);
    EXPECT_LE(
        largest_difference(integrated(*listed("bm1", *scene.flow), scene.initial, h, 10), expected),
        1e-13)
        << scene_name;
    EXPECT_GE(
        largest_difference(integrated(*listed("bm2", *scene.flow), scene.initial, h, 10), expected),
        1e-6);
  }
}

TEST(CrouchGrossman, IsTheCompositionOfExponentialStepsOfOrderTwo) {
  const Scene scene = smooth_scene(9);
  Matrix W = scene.initial, expected = scene.initial;
  listed("cg4", *scene.flow)->step(W, 0.4);
  const auto substep = listed("elp2", *scene.flow);
  for (const double fraction : yoshida4().fractions) substep->step(expected, 0.4 * fraction);
  EXPECT_LE(largest_difference(W, expected), 1e-14);
}

TEST(BogfjellmoMarthinsen, RefusesAWeightThatIsZeroAndAnotherJ) {
  const Scene scene = smooth_scene(5);
  Tableau tableau = gauss_tableau(2);
  tableau.b << 0.0, 1.0;
  expect_refused(
      [&] { BogfjellmoMarthinsen<Complex>(scene.flow, tableau, {}, ProductBackend::openblas); },
      "no b_i may be 0");
  const auto& [other_name, parameters] = tested_scenes().back();
  const Scene other = scene_by_name(other_name, parameters);
  for (const char* name : {"bm2", "cg4"}) {
    expect_refused([&] { made(integrator_entry(name), *other.flow); },
                   "for flows of skew-Hermitian matrices");
  }
}

}  // namespace
}  // namespace isosyrk::testing
