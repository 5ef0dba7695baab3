// Which listed methods are Poisson maps: ‖DΦ Π(W₀) DΦᵀ - Π(W₁)‖ on su(3), su(4) and so(4), and how
// it falls with h.
#include <fmt/format.h>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/linalg/spectrum.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

struct SmallAlgebra {
  std::string name;
  std::shared_ptr<const Flow> flow;
  Matrix W0;
};

// Modes of all degrees, so that no direction is special.
SmallAlgebra su(Index n, const std::vector<Mode>& modes) {
  const Scene scene = smooth_scene(n, HbarConvention::paper, modes);
  return {fmt::format("su{}", n), scene.flow, scene.initial};
}

// A rigid body on so(4) whose inertia is none of Manakov's: not integrable.
SmallAlgebra so4() {
  MatrixOf<double> c(4, 4);
  c << 0.0, 0.3, 1.1, 0.7, 0.3, 0.0, 0.5, 1.6, 1.1, 0.5, 0.0, 0.2, 0.7, 1.6, 0.2, 0.0;
  Matrix W0 = Matrix::Zero(4, 4);
  const double entries[] = {0.5, -0.8, 0.3, 0.6, -0.4, 0.7};
  for (Index i = 0, k = 0; i < 4; ++i) {
    for (Index j = i + 1; j < 4; ++j, ++k) {
      W0(i, j) = entries[k];
      W0(j, i) = -entries[k];
    }
  }
  return {"so4", std::make_shared<RealRigidBody>(QuadraticAlgebra::skew_hermitian(4), 0.5 * c),
          W0 / spectral_norm(W0)};
}

std::vector<SmallAlgebra> small_algebras() {
  return {
      su(3, {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {2, 0, 0.7}}),
      su(4,
         {{1, 0, 0.4}, {1, 1, {0.3, -0.8}}, {2, 1, {1.0, 0.3}}, {3, 2, {-0.6, 0.9}}, {3, 0, 0.7}}),
      so4()};
}

// The differences of poisson_map_defect leave at most 5e-12; the tolerance leaves nothing beside
// them.
constexpr double kept = 1e-10;
constexpr double lost = 1000.0 * kept;
constexpr double tolerance = 1e-15;
constexpr double long_step = 2.0;
// Explicit methods of order 8 and 10 lose nothing that is seen in the long step of the others.
double long_step_of(const IntegratorEntry& entry) {
  if (!entry.is_explicit || entry.order < 8) return long_step;
  return (entry.co_rotating ? 4.0 : 2.0) * long_step;
}

double defect_of(const IntegratorEntry& entry, const SmallAlgebra& small, double h) {
  return poisson_map_defect(*made(entry, *small.flow, {.tolerance = tolerance}), small.W0, h);
}

// The flows of small_algebras() that a method takes; a fast form takes those on su(n).
std::vector<SmallAlgebra> algebras_of(const IntegratorEntry& entry) {
  std::vector<SmallAlgebra> found;
  for (const SmallAlgebra& small : small_algebras()) {
    const bool on_su = dynamic_cast<const EulerZeitlin*>(small.flow.get()) != nullptr;
    if (entry.is_fast ? on_su : takes(entry, *small.flow)) found.push_back(small);
  }
  return found;
}

class Symplecticity : public ::testing::TestWithParam<IntegratorEntry> {};

TEST_P(Symplecticity, IsKeptIfAndOnlyIfTheListSaysSo) {
  for (const SmallAlgebra& small : algebras_of(GetParam())) {
    const double defect = defect_of(GetParam(), small, long_step_of(GetParam()));
    if (GetParam().keeps.lie_poisson) {
      EXPECT_LE(defect, kept) << small.name;
    } else {
      EXPECT_GE(defect, lost) << small.name;
    }
  }
}

class NoSymplecticity : public ::testing::TestWithParam<IntegratorEntry> {};

// A step of order p is a Poisson map up to h^(p + 1).  Below 1e-11 the differences show.
TEST_P(NoSymplecticity, FallsWithTheOrderOfTheStep) {
  const IntegratorEntry& entry = GetParam();
  const std::vector<long> counts =
      entry.order > 4 ? std::vector<long>{3, 4, 5, 6} : std::vector<long>{4, 6, 8};
  for (const SmallAlgebra& small : algebras_of(entry)) {
    const auto defect = [&](double h, long) { return defect_of(entry, small, h); };
    const auto floor = [](long) { return 1e-11; };
    const double order = observed_order(long_step_of(entry), counts, defect, floor, 2) - 1.0;
    // In the long steps of high orders the next term is seen too; of rk10 it is the larger one.
    const double before = entry.order < 8 ? 0.35 : 0.75;
    const double beyond = entry.order < 5 ? 0.35 : entry.order < 10 ? before + 0.15 : 1.25;
    EXPECT_GE(order, entry.order - before) << small.name;
    EXPECT_LE(order, entry.order + beyond) << small.name;
  }
}

std::vector<IntegratorEntry> listed(bool lie_poisson_too) {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.keeps.lie_poisson && !lie_poisson_too) continue;
    for (const IntegratorEntry& form : forms_of(entry)) found.push_back(form);
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(List, Symplecticity, ::testing::ValuesIn(listed(true)),
                         ::testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(List, NoSymplecticity, ::testing::ValuesIn(listed(false)),
                         ::testing::PrintToStringParamName());

// What is multiplied into a term of B̃, to spoil it: 1 leaves it as it is.
struct Factors {
  double first = 1.0;    // of B[μ, u], order 4
  double second = 1.0;   // of [u, v], order 4
  double h4 = 1.0;       // of all in h⁴, order 6
  double v_bar_4 = 1.0;  // of what h⁴ adds to v̄, order 6
};

// The modified gradients as another derivation has them, with f₂ = c + p:
//
//     order 4:  B̃ = v + (h²/12) (B [μ, u] + [u, v]),   u = Bf
//     order 6:  F₄ = (<f₂, Bf₂> + 5 <c, Bc> + 2 <f₂, w> + 4 <c, w>) / 1440
Matrix modified_gradient(const Flow& flow, int order, double h, const Matrix& mu,
                         const Factors& factors) {
  const auto B = [&](const Matrix& W) { return flow.dense_generator(W); };
  const Matrix v = B(mu), f = commutator(v, mu), u = B(f);
  const double h2 = h * h / 12.0;
  if (order == 4) {
    return v + h2 * (factors.first * B(commutator(mu, u)) + factors.second * commutator(u, v));
  }
  const double k = factors.h4 * std::pow(h, 4) / 1440.0;
  const Matrix c = commutator(u, mu), p = commutator(v, f), w = commutator(v, u), f2 = c + p;
  const Matrix p_bar = k * (2.0 * B(f2) + 2.0 * w);
  const Matrix c_bar = p_bar + k * (10.0 * B(c) + 4.0 * w);
  const Matrix w_bar = k * (2.0 * f2 + 4.0 * c);
  const Matrix u_bar = commutator(mu, c_bar) + commutator(w_bar, v);
  const Matrix f_bar = commutator(p_bar, v) + B(u_bar) + h2 * u;
  const Matrix v_bar =
      factors.v_bar_4 * (commutator(f, p_bar) + commutator(u, w_bar)) + commutator(mu, f_bar);
  return v + commutator(c_bar, u) + commutator(f_bar, v) + B(v_bar);
}

// elp2 with B̃ for B is the method of order 4 or 6 for steps of this h.
FlowOf modified_flow(const SmallAlgebra& small, int order, double h, const Factors& factors = {}) {
  return FlowOf(small.flow->algebra(),
                [&flow = *small.flow, order, h, factors](const Matrix& W, Matrix& B) {
                  B = modified_gradient(flow, order, h, W, factors);
                });
}

double defect_of_modified(const SmallAlgebra& small, int order, const Factors& factors) {
  const FlowOf flow = modified_flow(small, order, long_step, factors);
  return defect_of(integrator_entry("elp2"), {small.name, lent(flow), small.W0}, long_step);
}

TEST(ModifiedGradient, IsThatOfAnotherDerivation) {
  for (const SmallAlgebra& small : small_algebras()) {
    for (const int order : {4, 6}) {
      const FlowOf flow = modified_flow(small, order, long_step);
      const IterationOptions options = {.tolerance = tolerance};
      Matrix W = small.W0, expected = small.W0;
      const auto name = fmt::format("elp{}", order);
      made(integrator_entry(name), *small.flow, options)->step(W, long_step);
      made(integrator_entry("elp2"), flow, options)->step(expected, long_step);
      EXPECT_LE(largest_difference(W, expected), 1e-13) << small.name << name;
      EXPECT_GE(largest_difference(W, small.W0), 0.1);
      made(integrator_entry("elp2"), *small.flow, options)->step(expected = small.W0, long_step);
      EXPECT_GE(largest_difference(W, expected), 1e-3) << small.name << name;
    }
  }
}

// A coefficient that is 10 % off is seen if B̃ is then no gradient.
TEST(ModifiedGradient, WithAWrongCoefficientIsNoGradientAndTheStepNoPoissonMap) {
  for (const SmallAlgebra& small : small_algebras()) {
    EXPECT_LE(defect_of_modified(small, 4, {}), kept) << small.name;
    EXPECT_LE(defect_of_modified(small, 6, {}), kept) << small.name;
    EXPECT_GE(defect_of_modified(small, 4, {.first = 1.1}), lost) << small.name;
    EXPECT_GE(defect_of_modified(small, 4, {.second = 1.1}), lost) << small.name;
    EXPECT_GE(defect_of_modified(small, 6, {.v_bar_4 = 0.5}), lost) << small.name;
  }
}

// Half of F₄ is a modified Hamiltonian too: the step stays a Poisson map, and its order falls to 4.
TEST(ModifiedGradient, WithHalfOfItsFourthPowerIsAGradientAndTheOrderIsFour) {
  for (const SmallAlgebra& small : small_algebras()) {
    EXPECT_LE(defect_of_modified(small, 6, {.h4 = 0.5}), kept) << small.name;
    const double time = 2.0;
    const Matrix exact = integrated(*gauss(Formulation::group, *small.flow, 6, tolerance), small.W0,
                                    time / 40.0, 40);
    for (const auto& [h4, order] : {std::pair{1.0, 6.0}, {0.5, 4.0}, {0.0, 4.0}}) {
      const auto error = [&, of_h4 = h4](double h, long count) {
        const FlowOf flow = modified_flow(small, 6, h, {.h4 = of_h4});
        const auto method = made(integrator_entry("elp2"), flow, {.tolerance = tolerance});
        return largest_difference(integrated(*method, small.W0, h, count), exact);
      };
      const auto plateau = [](long) { return 1e-12; };
      EXPECT_NEAR(observed_order(time, {3, 4, 5, 6, 8, 10, 12}, error, plateau), order, 0.2)
          << small.name << " " << h4;
    }
  }
}

// Without a self-adjoint B even the method of order 2 is none.
TEST(ModifiedGradient, OfABThatIsNotSelfAdjointIsNone) {
  const SmallAlgebra small = small_algebras()[1];
  const Matrix turned = random_skew_hermitian(4, 3);
  const FlowOf flow(small.flow->algebra(), [&](const Matrix& W, Matrix& B) {
    small.flow->generator(W, B);
    B += 0.1 * commutator(turned, W);
  });
  const SmallAlgebra other = {"turned", lent(flow), small.W0};
  EXPECT_GE(defect_of(integrator_entry("elp2"), other, long_step), lost);
}

}  // namespace
}  // namespace isosyrk::testing
