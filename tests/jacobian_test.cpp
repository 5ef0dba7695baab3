// The Jacobian T + K of every stage system against central differences of its residual.
#include <functional>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/fast/direct_system.h"
#include "isosyrk/flows/split_generator.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/solver/alternating_correction.h"
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

// A flow whose Jacobian is T alone, since B is the B(W₀) of Euler-Zeitlin whatever W is.
class FrozenEulerZeitlin final : public Flow {
 public:
  explicit FrozenEulerZeitlin(const Matrix& W0)
      : Flow(QuadraticAlgebra::skew_hermitian(n)), B_(n, n) {
    EulerZeitlin(n).generator(W0, B_);
  }
  void generator(const Matrix&, Matrix& B) const override { B = B_; }
  double hamiltonian(const Matrix&) const override { return 0.0; }
  std::unique_ptr<SplitGenerator> split_generator() const override {
    return std::make_unique<Generator>(B_);
  }

 private:
  class Generator final : public SplitGenerator {
   public:
    explicit Generator(const Matrix& B) : B_(B) {}
    void upper_within(Index, std::span<const SplitMatrix>,
                      std::span<SplitMatrix> B) const override {
      for (SplitMatrix& each : B) each = B_;
    }
    void upper_within(Index, std::span<const SingleMatrix>,
                      std::span<SingleMatrix> B) const override {
      for (SingleMatrix& each : B) each.entries().setZero();
    }
    double norm_bound() const override { return EulerZeitlin(n).split_generator()->norm_bound(); }
    bool damps_fine_scales() const override { return true; }

   private:
    SplitMatrix B_;
  };

  Matrix B_;
};

struct NamedSystem {
  std::string name;
  std::function<std::unique_ptr<StageSystem>(const Flow&)> make;
};

void PrintTo(const NamedSystem& system, std::ostream* out) { *out << system.name; }

// Every form of Gauss methods, and the control applied to W itself.
std::vector<NamedSystem> systems() {
  std::vector<NamedSystem> all;
  for (const Method& method : methods(4)) {
    all.push_back({::testing::PrintToString(method), [method](const Flow& flow) {
                     return gauss_system(method.formulation, method.s, flow, 1, false);
                   }});
  }
  for (int s = 1; s <= 4; ++s) {
    all.push_back({"direct" + std::to_string(s), [s](const Flow& flow) {
                     return std::make_unique<DirectSystem>(flow, gauss_tableau(s), 1, false);
                   }});
  }
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
  AtSolution(const NamedSystem& tested, const Flow& flow, const Matrix& initial, bool backwards)
      : system(tested.make(flow)),
        memory(system->memory()),
        W0(initial),
        x(system->unknowns()),
        zero(corrections_like(x)) {
    Matrix B(n, n);
    flow.generator(initial, B);
    system->bind(W0, (backwards ? -h_norm_B : h_norm_B) / spectral_norm(B), 1e-13, *memory);
    system->start(x, Start::cold);
    Corrections R = zero;
    double change = 1.0;
    for (int k = 0; k < 100 && change > 1e-13; ++k) {
      change = system->residual(R, x, 1e-13).change;
      add(x, R);
    }
    EXPECT_LE(change, 1e-13);
  }

  Corrections rounded(const RealVector& d) const { return with_numbers(zero, d); }

  // Of norm 1, with the structure of what it corrects: M_jj and W̃ are skew-Hermitian.
  RealVector direction(unsigned seed) const {
    Unknowns d = x;
    for (SplitStages& kind : d) {
      for (SplitMatrix& matrix : kind) {
        const Matrix random = random_matrix(n, seed++);
        const bool is_skew = skew_defect(matrix.interleaved()) < 1e-12;
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
      system->residual(R, moved, 1e-13);
      return numbers_of(R);
    };
    const RealVector change = residual_at(difference_step) - residual_at(-difference_step);
    Corrections R = zero;
    system->residual(R, x, 1e-13);
    jacobian().linearise(x, 1e-7);
    return d + 0.5 / difference_step * change;
  }

  // K d.
  RealVector coupled(const RealVector& d) {
    Corrections result = zero;
    jacobian().couple(result, rounded(d));
    return numbers_of(result);
  }

  // rhs + T d, or rhs - T d.  Where frozen sweeps are solutions, 2 rhs - (1 - T)⁻¹ rhs has the
  // wrong sign to first order.
  RealVector swept(const RealVector& rhs, const RealVector& d, double sign_of_T) {
    Corrections delta = rounded(d);
    jacobian().frozen_sweep(delta, rounded(rhs));
    return rhs + sign_of_T * (numbers_of(delta) - rhs);
  }

  // The systems of Gauss methods have a Jacobian in two parts.
  TwoPartJacobian& jacobian() { return dynamic_cast<TwoPartJacobian&>(*system); }

  std::unique_ptr<StageSystem> system;
  std::unique_ptr<StepMemory> memory;
  SplitMatrix W0;
  Unknowns x;
  Corrections zero;
};

class Jacobian : public ::testing::TestWithParam<NamedSystem> {
 protected:
  // Calls test(at, d) for a smooth and a random W₀, forwards and backwards.
  template <class FlowOfState, class Test>
  void for_states(const FlowOfState& flow_of, const Test& test) const {
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
TEST_P(Jacobian, IsTheDerivativeAndAWrongSignOfEitherPartIsSeen) {
  const auto euler_zeitlin = [](const Matrix&) { return EulerZeitlin(n); };
  for_states(euler_zeitlin, [](AtSolution& at, const RealVector& d) {
    const RealVector rest = d - at.derivative(d), K_d = at.coupled(d);
    const auto miss = [&](double sign_of_T, double sign_of_K) {
      return (at.swept(rest + sign_of_K * K_d, d, sign_of_T) - d).norm();
    };
    EXPECT_LE(miss(1.0, 1.0), 2.0 * roundings);
    EXPECT_GT(miss(-1.0, 1.0), 200.0 * roundings);
    EXPECT_GT(miss(1.0, -1.0), 200.0 * roundings);
  });
}

// With B the same for every W, δ = rhs + G'δ; frozen sweeps contract by 0.3 and a few stages.  And
// with the sum of both the coupling is known by itself.
TEST_P(Jacobian, HasAFrozenPartByItself) {
  const auto frozen = [](const Matrix& W0) { return FrozenEulerZeitlin(W0); };
  for_states(frozen, [](AtSolution& at, const RealVector& rhs) {
    const auto miss = [&](double sign_of_T) {
      at.derivative(rhs);
      RealVector found = rhs;
      for (int k = 0; k < 60; ++k) found = at.swept(rhs, found, sign_of_T);
      return (found - at.derivative(found) - rhs).norm() / found.norm();
    };
    EXPECT_LE(miss(1.0), roundings);
    EXPECT_GT(miss(-1.0), 100.0 * roundings);
    EXPECT_EQ(at.coupled(rhs).norm(), 0.0) << "nothing is coupled";
  });
}

INSTANTIATE_TEST_SUITE_P(All, Jacobian, ::testing::ValuesIn(systems()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
