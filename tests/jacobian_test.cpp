// The Jacobian T + K of every stage system against central differences of its residual.
#include <gtest/gtest.h>

#include "isosyrk/flows/split_generator.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/solver/inexact_newton.h"
#include "isosyrk/split/linear_combination.h"
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

// A flow whose Jacobian is the whole T + K; or T alone, since B is B(W₀) whatever W is; or K alone,
// since B = B(W - W₀) is 0 at the solution, which is the cold start.
enum class Part { both, frozen, coupling };

class PartOfEulerZeitlin final : public Flow {
 public:
  PartOfEulerZeitlin(const Matrix& W0, Part part)
      : Flow(QuadraticAlgebra::skew_hermitian(n)), whole_(n), W0_(W0), part_(part) {}
  void generator(const Matrix& W, Matrix& B) const override { whole_.generator(W, B); }
  double hamiltonian(const Matrix&) const override { return 0.0; }
  std::unique_ptr<SplitGenerator> split_generator() const override {
    return std::make_unique<Generator>(whole_, W0_, part_);
  }

 private:
  class Generator final : public SplitGenerator {
   public:
    Generator(const EulerZeitlin& flow, const Matrix& W0, Part part)
        : whole_(flow.split_generator()), of_W0_(split_stages(1, n)), part_(part) {
      whole_->upper({SplitMatrix(W0)}, of_W0_);
    }
    void upper(const SplitStages& W, SplitStages& B) const override {
      whole_->upper(W, B);
      for (SplitMatrix& each : B) {
        if (part_ == Part::frozen) each.entries() = of_W0_[0].entries();
        if (part_ == Part::coupling) each.entries() -= of_W0_[0].entries();
      }
    }
    void upper_within(Index band, const SingleStages& W, SingleStages& B) const override {
      whole_->upper_within(band, W, B);
      if (part_ != Part::frozen) return;
      for (SingleMatrix& each : B) each.entries().setZero();
    }
    double norm_bound() const override { return whole_->norm_bound(); }
    bool damps_fine_scales() const override { return true; }

   private:
    std::unique_ptr<SplitGenerator> whole_;
    SplitStages of_W0_;
    Part part_;
  };

  EulerZeitlin whole_;
  Matrix W0_;
  Part part_;
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

// Corrections as vectors in double precision.
Unknowns widened(const Corrections& delta) {
  Unknowns wide;
  for (const SingleStages& kind : delta) {
    auto& of_kind = wide.emplace_back();
    for (const SingleMatrix& each : kind) of_kind.emplace_back(each.interleaved());
  }
  return wide;
}

Corrections rounded(const Unknowns& x) {
  Corrections R = corrections_like(x);
  for (std::size_t kind = 0; kind < x.size(); ++kind) round_to_single(x[kind], R[kind]);
  return R;
}

// a x + b y
Unknowns sum(double a, const Unknowns& x, double b, const Unknowns& y) {
  Unknowns result = x;
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    for (std::size_t i = 0; i < x[kind].size(); ++i) {
      result[kind][i].entries() = a * x[kind][i].entries() + b * y[kind][i].entries();
    }
  }
  return result;
}

double norm(const Unknowns& x) {
  double squares = 0.0;
  for (const SplitStages& kind : x) {
    for (const SplitMatrix& each : kind) squares += each.entries().squaredNorm();
  }
  return std::sqrt(squares);
}

// A system bound to a step with h‖B‖ = 0.3, at its solution.
struct AtSolution {
  AtSolution(const Method& tested, const Matrix& initial, bool backwards, Part part)
      : method(tested),
        flow(initial, part),
        system(stage_system(tested, flow, 1, false)),
        W0(initial) {
    Matrix B(n, n);
    flow.generator(initial, B);
    const double h = (backwards ? -h_norm_B : h_norm_B) / spectral_norm(B);
    x = system->unknowns();
    system->bind(W0, h, 1e-13);
    system->cold_start(x);
    Corrections R = corrections_like(x);
    double change = 1.0;
    for (int k = 0; k < 100 && change > 1e-13; ++k) {
      change = system->residual(x, 1e-13, R);
      for (std::size_t each = 0; each < x.size(); ++each) add(R[each], x[each]);
    }
    EXPECT_LE(change, 1e-13);
    linearise();
  }

  void linearise() {
    Corrections R = corrections_like(x);
    system->residual(x, 1e-13, R);
    system->linearise(1e-7);
  }

  // Of norm 1, with the structure of what it corrects: M_jj and the midpoint's W̃ are
  // skew-Hermitian.
  Unknowns direction(unsigned seed) const {
    Unknowns d = x;
    for (std::size_t each = 0; each < d.size(); ++each) {
      const bool is_skew =
          method.formulation == Formulation::algebra && (method.s == 1 || each == 1);
      for (SplitMatrix& matrix : d[each]) {
        const Matrix random = random_matrix(n, seed++);
        matrix = SplitMatrix(is_skew ? Matrix(random - random.adjoint()) : random);
      }
    }
    const double size = norm(d);
    for (SplitStages& each : d) {
      for (SplitMatrix& matrix : each) matrix.entries() /= size;
    }
    return widened(rounded(d));
  }

  // G'(x) d.
  Unknowns derivative(const Unknowns& d) {
    Corrections ahead = corrections_like(x), behind = ahead;
    Unknowns moved = sum(1.0, x, difference_step, d);
    system->residual(moved, 1e-13, ahead);
    moved = sum(1.0, x, -difference_step, d);
    system->residual(moved, 1e-13, behind);
    const double scale = 0.5 / difference_step;
    linearise();
    return sum(1.0, d, 1.0, sum(scale, widened(ahead), -scale, widened(behind)));
  }

  Method method;
  PartOfEulerZeitlin flow;
  std::unique_ptr<StageSystem> system;
  SplitMatrix W0;
  Unknowns x;
};

// By how much the correction that solves for R = d - G'd misses d, relatively.
double miss_of_newton(AtSolution& at, FixedPointSystem& system, unsigned seed) {
  // Small, so that the forcing term is 1e-6 of it.
  constexpr double size = 1e-6;
  const Unknowns d = at.direction(seed);
  const Unknowns R = sum(size, d, -size, at.derivative(d));
  InexactNewton solver(at.x);
  if (!solver.correct(system, rounded(R), norm(R), {.tolerance = 1e-13})) return 1e3;
  return norm(sum(1.0 / size, widened(solver.correction()), -1.0, d));
}

class Jacobian : public ::testing::TestWithParam<Method> {
 protected:
  // Calls test(at, seed) for a smooth and a random W₀, forwards and backwards.
  template <class Test>
  void for_states(Part part, Test&& test) const {
    const Scene scene = smooth_scene(n);
    unsigned seed = 1;
    for (const Matrix& W0 : {scene.initial, random_skew_hermitian(n, 7)}) {
      for (const bool backwards : {false, true}) {
        SCOPED_TRACE(::testing::Message() << (seed < 200 ? "smooth" : "random") << backwards);
        AtSolution at(GetParam(), W0, backwards, part);
        test(at, seed);
        seed += 100;
      }
    }
  }
};

// The forcing term leaves 1e-6 of R, |R| < 2, by an estimate that may be out by a factor of 3; and
// 1 / (1 - |T + K|) < 2 of it and of the roundings is left in δ.
constexpr double newton_bound = 2.0 * (3.0 * 2e-6 + roundings);

TEST_P(Jacobian, IsWhatInexactNewtonSolvesWithAndAWrongSignOfEitherPartIsSeen) {
  for_states(Part::both, [](AtSolution& at, unsigned seed) {
    EXPECT_LE(miss_of_newton(at, *at.system, seed), newton_bound);
    WrongSign T(*at.system, true, false), K(*at.system, false, true);
    EXPECT_GT(miss_of_newton(at, T, seed), 100.0 * newton_bound);
    EXPECT_GT(miss_of_newton(at, K, seed), 100.0 * newton_bound);
  });
}

// With B the same for every W, δ = rhs + G'δ; frozen sweeps contract by 0.3 and a few stages.
double miss_of_frozen_sweeps(AtSolution& at, FixedPointSystem& system, unsigned seed) {
  const Unknowns rhs = at.direction(seed);
  const Corrections right = rounded(rhs);
  Corrections delta = right;
  for (int k = 0; k < 60; ++k) system.frozen_sweep(right, delta);
  const Unknowns found = widened(delta);
  return norm(sum(1.0, sum(1.0, found, -1.0, at.derivative(found)), -1.0, rhs)) / norm(found);
}

TEST_P(Jacobian, HasAFrozenPartByItself) {
  for_states(Part::frozen, [](AtSolution& at, unsigned seed) {
    EXPECT_LE(miss_of_frozen_sweeps(at, *at.system, seed), roundings);
    WrongSign wrong(*at.system, true, false);
    EXPECT_GT(miss_of_frozen_sweeps(at, wrong, seed), 100.0 * roundings);
    // Nothing is coupled.
    Corrections coupled = corrections_like(at.x);
    at.system->couple(rounded(at.direction(seed)), coupled);
    EXPECT_EQ(norm(widened(coupled)), 0.0);
  });
}

TEST_P(Jacobian, HasACouplingByItself) {
  for_states(Part::coupling, [](AtSolution& at, unsigned seed) {
    const Unknowns d = at.direction(seed);
    const Unknowns expected = at.derivative(d);
    Corrections coupled = corrections_like(at.x);
    at.system->couple(rounded(d), coupled);
    EXPECT_LE(norm(sum(1.0, widened(coupled), -1.0, expected)), roundings);
    EXPECT_GT(norm(expected), 1e-2) << "a coupling with the wrong sign misses by twice that";
    // Nothing moves with B frozen at 0.
    Corrections delta = rounded(d);
    EXPECT_LE(at.system->frozen_sweep(rounded(d), delta), roundings);
  });
}

INSTANTIATE_TEST_SUITE_P(All, Jacobian, ::testing::ValuesIn(methods(4)),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
