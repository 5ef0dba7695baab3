// The Jacobian T + K of every stage system against central differences of its residual.
#include <gtest/gtest.h>

#include "isosyrk/fast/direct_system.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/split/linear_combination.h"
#include "isosyrk/tableaux/gauss_tableau.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

constexpr Index n = 9;
constexpr double h_norm_B = 0.3;

// T and K are formed in single precision: products of n terms, in sums over stages, each rounding
// by 2⁻²⁴ of |h B| and |δ| = 1, so that 64 roundoffs, 4e-6, hold them with room to spare. Residuals
// are rounded too: at the solution they are as large as the difference itself, so that central
// differences err by 2⁻²⁴ of |G'δ - δ|, and by ε²/6 of the third derivative, some 1e-9.
constexpr double roundings = 64 * 0x1p-24;
constexpr double difference_step = 1e-4;

// A flow whose Jacobian is T alone, since B is B(W₀) whatever W is.
class FrozenEulerZeitlin final : public Flow {
 public:
  explicit FrozenEulerZeitlin(const Matrix& W0)
      : Flow(QuadraticAlgebra::skew_hermitian(n)), whole_(n), W0_(W0) {}
  void generator(const Matrix&, Matrix& B) const override { whole_.generator(W0_, B); }
  double hamiltonian(const Matrix&) const override { return 0.0; }
  std::unique_ptr<SplitGenerator> split_generator() const override {
    return std::make_unique<Generator>(whole_, W0_);
  }

 private:
  class Generator final : public SplitGenerator {
   public:
    Generator(const EulerZeitlin& flow, const Matrix& W0)
        : whole_(flow.split_generator()), of_W0_(split_stages(1, n)) {
      whole_->upper({SplitMatrix(W0)}, of_W0_);
    }
    void upper(const SplitStages&, SplitStages& B) const override {
      for (SplitMatrix& each : B) each = of_W0_[0];
    }
    void upper_within(Index, const SingleStages&, SingleStages& B) const override {
      for (SingleMatrix& each : B) each.entries().setZero();
    }
    double norm_bound() const override { return whole_->norm_bound(); }
    bool damps_fine_scales() const override { return true; }

   private:
    std::unique_ptr<SplitGenerator> whole_;
    SplitStages of_W0_;
  };

  EulerZeitlin whole_;
  Matrix W0_;
};

// A system with the sign of a part of its Jacobian wrong.  Where frozen sweeps are solutions,
// 2 rhs - (1 - T)⁻¹ rhs has it wrong to first order.
class WrongSign final : public FixedPointSystem {
 public:
  WrongSign(FixedPointSystem& system, bool of_T, bool of_K)
      : system_(system), of_T_(of_T), of_K_(of_K) {}
  double residual(Unknowns& x, double accuracy, Corrections& R) override {
    return system_.residual(x, accuracy, R);
  }
  void linearise(double accuracy) override { system_.linearise(accuracy); }
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override {
    const double change = system_.frozen_sweep(rhs, delta);
    if (!of_T_) return change;
    for (std::size_t kind = 0; kind < delta.size(); ++kind) {
      for (std::size_t i = 0; i < delta[kind].size(); ++i) {
        delta[kind][i].entries() = 2.0f * rhs[kind][i].entries() - delta[kind][i].entries();
      }
    }
    return change;
  }
  bool solves_frozen() const override { return system_.solves_frozen(); }
  void couple(const Corrections& delta, Corrections& coupled) override {
    system_.couple(delta, coupled);
    if (!of_K_) return;
    for (SingleStages& kind : coupled) {
      for (SingleMatrix& each : kind) each.entries() *= -1.0f;
    }
  }

 private:
  FixedPointSystem& system_;
  bool of_T_, of_K_;
};

// A form of Gauss methods, or the control applied to W itself.
struct Case {
  Method method;
  bool direct = false;

  std::unique_ptr<StageSystem> system(const Flow& flow) const {
    if (!direct) return stage_system(method, flow, 1, false);
    return std::make_unique<DirectSystem>(flow, gauss_tableau(method.s), 1, false);
  }
};

void PrintTo(const Case& tested, std::ostream* out) {
  if (tested.direct) {
    *out << "direct" << tested.method.s;
  } else {
    PrintTo(tested.method, out);
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Method& method : methods(4)) all.push_back({method});
  for (int s = 1; s <= 4; ++s) all.push_back({{Formulation::cotangent, s}, true});
  return all;
}

// All numbers of unknowns or corrections, and the same with other numbers.
template <class Kinds>
RealVector numbers_of(const Kinds& kinds) {
  std::vector<double> numbers;
  for (const auto& kind : kinds) {
    for (const auto& each : kind) {
      numbers.insert(numbers.end(), each.entries().begin(), each.entries().end());
    }
  }
  return Eigen::Map<RealVector>(numbers.data(), static_cast<Index>(numbers.size()));
}
template <class Kinds>
Kinds with_numbers(Kinds kinds, const RealVector& numbers) {
  Index next = 0;
  for (auto& kind : kinds) {
    for (auto& each : kind) {
      for (auto& entry : each.entries()) {
        entry = static_cast<std::decay_t<decltype(entry)>>(numbers(next++));
      }
    }
  }
  return kinds;
}

// A system bound to a step with h‖B‖ = 0.3, at its solution.
struct AtSolution {
  AtSolution(const Case& case_tested, const Flow& flow, const Matrix& initial, bool backwards)
      : tested(case_tested), system(tested.system(flow)), W0(initial) {
    Matrix B(n, n);
    flow.generator(initial, B);
    const double h = (backwards ? -h_norm_B : h_norm_B) / spectral_norm(B);
    x = system->unknowns();
    zero = corrections_like(x);
    system->bind(W0, h, 1e-13);
    system->cold_start(x);
    Corrections R = zero;
    double change = 1.0;
    for (int k = 0; k < 100 && change > 1e-13; ++k) {
      change = system->residual(x, 1e-13, R);
      for (std::size_t each = 0; each < x.size(); ++each) add(R[each], x[each]);
    }
    EXPECT_LE(change, 1e-13);
  }

  Corrections rounded(const RealVector& d) const { return with_numbers(zero, d); }

  // Of norm 1, with the structure of what it corrects: M_jj and W̃ are
  // skew-Hermitian.
  RealVector direction(unsigned seed) const {
    Unknowns d = x;
    for (std::size_t each = 0; each < d.size(); ++each) {
      const auto [formulation, s] = tested.method;
      const bool is_skew =
          tested.direct || (formulation == Formulation::algebra && (s == 1 || each == 1));
      for (SplitMatrix& matrix : d[each]) {
        const Matrix random = random_matrix(n, seed++);
        matrix = SplitMatrix(is_skew ? Matrix(random - random.adjoint()) : random);
      }
    }
    return numbers_of(rounded(numbers_of(d).normalized()));
  }

  // G'(x) d.  Leaves the system linearised at x.
  RealVector derivative(const RealVector& d) {
    const auto residual_at = [&](double step) {
      Unknowns moved = with_numbers(x, numbers_of(x) + step * d);
      Corrections R = zero;
      system->residual(moved, 1e-13, R);
      return numbers_of(R);
    };
    const RealVector change = residual_at(difference_step) - residual_at(-difference_step);
    Corrections R = zero;
    system->residual(x, 1e-13, R);
    system->linearise(1e-7);
    return d + 0.5 / difference_step * change;
  }

  Case tested;
  std::unique_ptr<StageSystem> system;
  SplitMatrix W0;
  Unknowns x;
  Corrections zero;
};

class Jacobian : public ::testing::TestWithParam<Case> {
 protected:
  // Calls test(at, d) for a smooth and a random W₀, forwards and backwards.
  template <class FlowOf, class Test>
  void for_states(const FlowOf& flow_of, const Test& test) const {
    unsigned seed = 1;
    for (const Matrix& W0 : {smooth_scene(n).initial, random_skew_hermitian(n, 7)}) {
      for (const bool backwards : {false, true}) {
        SCOPED_TRACE(::testing::Message() << (seed < 200 ? "smooth" : "random") << backwards);
        const auto flow = flow_of(W0);
        AtSolution at(GetParam(), flow, W0, backwards);
        test(at, at.direction(seed));
        seed += 100;
      }
    }
  }
};

// One frozen sweep with the right-hand side (1 - G') d + K d leaves d where it is.  Where frozen
// sweeps are solutions, 1 / (1 - |T|) < 2 of the roundings is left.
double miss_of_the_sum(AtSolution& at, FixedPointSystem& system, const RealVector& d) {
  const RealVector rest = d - at.derivative(d);
  Corrections delta = at.rounded(d), coupled = at.zero;
  system.couple(delta, coupled);
  system.frozen_sweep(at.rounded(rest + numbers_of(coupled)), delta);
  return (numbers_of(delta) - d).norm();
}

TEST_P(Jacobian, IsTheDerivativeAndAWrongSignOfEitherPartIsSeen) {
  const auto euler_zeitlin = [](const Matrix&) { return EulerZeitlin(n); };
  for_states(euler_zeitlin, [](AtSolution& at, const RealVector& d) {
    EXPECT_LE(miss_of_the_sum(at, *at.system, d), 2.0 * roundings);
    WrongSign T(*at.system, true, false), K(*at.system, false, true);
    EXPECT_GT(miss_of_the_sum(at, T, d), 200.0 * roundings);
    EXPECT_GT(miss_of_the_sum(at, K, d), 200.0 * roundings);
  });
}

// With B the same for every W, δ = rhs + G'δ; frozen sweeps contract by 0.3 and a few stages.
double miss_of_frozen_sweeps(AtSolution& at, FixedPointSystem& system, const RealVector& rhs) {
  at.derivative(rhs);
  const Corrections right = at.rounded(rhs);
  Corrections delta = right;
  for (int k = 0; k < 60; ++k) system.frozen_sweep(right, delta);
  const RealVector found = numbers_of(delta);
  return (found - at.derivative(found) - rhs).norm() / found.norm();
}

// And with the sum of both the coupling is known by itself.
TEST_P(Jacobian, HasAFrozenPartByItself) {
  const auto frozen = [](const Matrix& W0) { return FrozenEulerZeitlin(W0); };
  for_states(frozen, [](AtSolution& at, const RealVector& d) {
    EXPECT_LE(miss_of_frozen_sweeps(at, *at.system, d), roundings);
    WrongSign wrong(*at.system, true, false);
    EXPECT_GT(miss_of_frozen_sweeps(at, wrong, d), 100.0 * roundings);
    // Nothing is coupled.
    Corrections coupled = at.zero;
    at.system->couple(at.rounded(d), coupled);
    EXPECT_EQ(numbers_of(coupled).norm(), 0.0);
  });
}

INSTANTIATE_TEST_SUITE_P(All, Jacobian, ::testing::ValuesIn(cases()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
