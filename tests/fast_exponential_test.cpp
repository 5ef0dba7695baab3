// The fast exponential methods and their parts: each against its published form or its definition,
// at every tolerance, and what becomes of steps that are too long.
#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/fast/exponential_system.h"
#include "isosyrk/fast/graded_series.h"
#include "isosyrk/fast/stage_generator.h"
#include "isosyrk/fast/start_choice.h"
#include "isosyrk/fast/start_error.h"
#include "isosyrk/fast/term_growth.h"
#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/solver/acceptance.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// ---- the methods

const std::vector<std::string> implicit_names = {"elp2", "elp4", "elp6"};
const std::vector<std::string> explicit_names = {"magnus4", "magnus5"};

class EachFastExponential : public ::testing::TestWithParam<std::string> {
 protected:
  const IntegratorEntry& entry = integrator_entry(GetParam());

  std::unique_ptr<Integrator> fast(const Scene& scene, double tolerance,
                                   std::optional<bool> bands = {}) const {
    FastOptions options = {.iteration = {.tolerance = tolerance}};
    options.bands = bands;
    return made(fast_entry(entry, options), *scene.flow, options.iteration);
  }

  // Takes single steps of growing length from the initial state.  Expects those that converge to be
  // right, and returns how many failed.
  long failures_of_long_steps(Index n, double tolerance) const {
    long failed = 0;
    for (const bool is_rough : {false, true}) {
      const Scene scene = is_rough ? rough_scene(n) : smooth_scene(n);
      for (double h = 0.5; h < 200.0; h *= 1.7) {
        SCOPED_TRACE(::testing::Message() << n << " " << is_rough << " " << tolerance << " " << h);
        const auto published = made(entry, *scene.flow, {.tolerance = 1e-13, .max_sweeps = 300});
        const auto method = fast(scene, tolerance);
        Matrix expected = scene.initial, W = scene.initial;
        const bool works = method->step(W, h).status == Status::converged;
        EXPECT_LE(spectrum_error(W, scene.initial), 2e-14);
        if (!works) {
          ++failed;
          EXPECT_EQ(W, scene.initial);
        } else if (published->step(expected, h).status == Status::converged) {
          EXPECT_LE((W - expected).norm() / expected.norm(), 1e2 * tolerance);
        }
      }
    }
    return failed;
  }
};

std::vector<std::string> names_with_frames() {
  std::vector<std::string> names;
  for (const std::vector<std::string>& some : {implicit_names, explicit_names}) {
    for (const std::string& name : some) {
      names.push_back(name);
      names.push_back(name + "_frame");
    }
  }
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, EachFastExponential, ::testing::ValuesIn(names_with_frames()),
                         [](const auto& tested) { return tested.param; });

// The tolerance bounds the error of Ω, relative to ‖Ω‖: about that of W₁ relative to ‖W₀‖, times
// h‖B‖.  Both forms err so, and a flow that shears lets errors grow over ten steps: 3 tolerances a
// step.  At 1e-13 the rounding of both forms is a few tolerances more in a step of elp6.
TEST_P(EachFastExponential, EqualsThePublishedFormToAnyToleranceAndKeepsTheSpectrumToRounding) {
  constexpr long steps = 10;
  for (const Index n : {2, 5, 17, 34, 65}) {  // with bands from 48 on
    for (const bool is_rough : {false, true}) {
      if (n < 5 && !is_rough) continue;  // the smooth data need n >= 5
      const Scene scene = is_rough ? rough_scene(n) : smooth_scene(n);
      const Matrix expected = integrated(*made(entry, *scene.flow), scene.initial, 0.25, steps);
      double loose_difference = 0.0;
      for (const double tolerance : {1e-13, 1e-10, 1e-8, 1e-6}) {
        SCOPED_TRACE(::testing::Message() << n << (is_rough ? " rough " : " smooth ") << tolerance);
        const auto method = fast(scene, tolerance);
        const Matrix W = integrated(*method, scene.initial, 0.25, steps);
        const double difference = (W - expected).norm() / expected.norm();
        const double of_a_step = tolerance < 1e-12 ? 10.0 : 3.0;
        EXPECT_LE(difference, of_a_step * static_cast<double>(steps) * tolerance);
        EXPECT_LE(spectrum_error(W, scene.initial), 1e-14);
        EXPECT_EQ(skew_defect(W), 0.0);
        loose_difference = difference;
      }
      // The control: a loose tolerance is seen.
      if (n > 5) {
        EXPECT_GT(loose_difference, 1e-12) << n;
      }
    }
  }
}

// At a tight tolerance Ω is formed in double precision: only bands leave out a part of the
// tolerance, a hundredth a step of each factor.  Single precision would show as 6e-8 h‖B‖ a step.
TEST(EachFastMagnus, IsThePublishedFormToATenthOfATightToleranceAStep) {
  constexpr long steps = 10;
  for (const std::string& name : explicit_names) {
    for (const Index n : {17, 65}) {
      for (const Scene& scene : {smooth_scene(n), rough_scene(n)}) {
        const Matrix expected =
            integrated(*made(integrator_entry(name), *scene.flow), scene.initial, 0.25, steps);
        for (const double tolerance : {1e-7, 1e-8}) {
          const auto method =
              made(fast_entry(name, {.iteration = {.tolerance = tolerance}}), *scene.flow);
          const Matrix W = integrated(*method, scene.initial, 0.25, steps);
          EXPECT_LE((W - expected).norm() / expected.norm(), 0.1 * steps * tolerance)
              << name << " " << n << " " << tolerance;
        }
      }
    }
  }
}

// U is unitary to rounding, so its errors in 4000 steps are a walk of 4000 roundings: sqrt(4000) of
// them are 1.4e-14.  Half a rounding in one direction would be 4e-13.
TEST(FastMagnus, KeepsTheSpectrumToRoundingOverManySteps) {
  const Scene scene = rough_scene(17);
  const Matrix W = integrated(*made(fast_entry("magnus4"), *scene.flow), scene.initial, 1.0, 4000);
  EXPECT_LE(spectrum_error(W, scene.initial), 3e-14);
}

// What a series or polynomial cannot do is a status.  What has converged is the published answer.
TEST_P(EachFastExponential, AStepThatIsTooLongSaysSoOrIsRight) {
  EXPECT_GT(failures_of_long_steps(9, 1e-13), 0);
  EXPECT_GT(failures_of_long_steps(9, 1e-8), 0);
}
TEST_P(EachFastExponential, ALargeStepWithBandsThatIsTooLongSaysSoOrIsRight) {
  EXPECT_GT(failures_of_long_steps(49, 1e-8), 0);
}

TEST_P(EachFastExponential, BandsSaveProductsInASmoothSceneAndChangeNothing) {
  const Scene scene = smooth_scene(65);
  double products[2];
  Matrix W[2];
  for (const bool bands : {false, true}) {
    const auto method = fast(scene, 1e-10, bands);
    W[bands] = scene.initial;
    const RunReport report = run(*method, W[bands], 0.25, 8);
    EXPECT_TRUE(report.converged());
    EXPECT_LE(spectrum_error(W[bands], scene.initial), 1e-14);
    products[bands] = report.work.equivalent_products;
  }
  EXPECT_LT(products[1], 0.9 * products[0]);
  EXPECT_LE(largest_difference(W[0], W[1]), 1e-9);
}

class EachFastLiePoisson : public EachFastExponential {};
INSTANTIATE_TEST_SUITE_P(All, EachFastLiePoisson, ::testing::ValuesIn(implicit_names),
                         [](const auto& tested) { return tested.param; });

// At fine steps past ones predict better than the explicit method, at coarse steps they do not.
TEST_P(EachFastLiePoisson, StartsFromPastStepsWhereThesePredictBetter) {
  const Scene scene = rough_scene(17);
  const auto last_start = [&](double h, std::optional<int> past_steps) {
    const auto method =
        made(fast_entry(entry, {.iteration = {.tolerance = 1e-8}, .past_steps = past_steps}),
             *scene.flow, {.tolerance = 1e-8});
    Matrix W = scene.initial;
    StepReport report;
    for (int step = 0; step < 40; ++step) report = continued(*method, W, h);
    EXPECT_EQ(report.status, Status::converged);
    return report.attempt.start;
  };
  EXPECT_EQ(last_start(0.02, {}), Start::predicted);
  EXPECT_EQ(last_start(1.0, {}), Start::stepped);
  EXPECT_EQ(last_start(0.02, 0), Start::stepped) << "the control: there are no past steps";
}

// A Jacobian with bands cut at a loose tolerance is still that of the step: one correction, or two.
TEST_P(EachFastLiePoisson, TakesTwoSweepsAStepAtMostAtALooseToleranceWithBands) {
  const Scene scene = rough_scene(65);
  Matrix W = scene.initial;
  const RunReport report = run(*fast(scene, 1e-5), W, 0.25, 5);
  EXPECT_TRUE(report.converged());
  EXPECT_LE(report.sweeps, 2 * report.steps);
}

// The first step back judges the size of its terms by |h|.  The error of Ω is below the tolerance,
// and that of W₁ by the factor h‖B‖ = 0.65 smaller; the published form may err as much.
TEST_P(EachFastLiePoisson, AStepBackIsThatOfThePublishedForm) {
  for (const Scene& scene : {smooth_scene(33), rough_scene(33)}) {
    const Matrix expected = integrated(*made(entry, *scene.flow), scene.initial, -0.25, 1);
    for (const double tolerance : {1e-12, 1e-11, 1e-8}) {
      const Matrix W = integrated(*fast(scene, tolerance), scene.initial, -0.25, 1);
      EXPECT_LE((W - expected).norm() / expected.norm(), 2.0 * tolerance) << tolerance;
    }
  }
}

TEST_P(EachFastLiePoisson, OneSweepAStepAndFewerProductsThanThePublishedForm) {
  const Scene scene = smooth_scene(33);
  Matrix W = scene.initial, V = scene.initial;
  const RunReport plain = run(*made(entry, *scene.flow, {.tolerance = 1e-8}), V, 0.25, 20);
  const RunReport report = run(*fast(scene, 1e-8), W, 0.25, 20);
  // The tolerance is far above rounding, which decides of no sweep here.
  EXPECT_LE(report.sweeps, 22);
  EXPECT_LT(report.work.equivalent_products, 0.3 * plain.work.equivalent_products);
}

// ---- without one part each

// What a run takes without something, and how far it is from the published form.
struct Ablated {
  Work work;
  long sweeps;
  double difference;
};

const FastOptions complete = {.iteration = {.tolerance = 1e-8}};

Ablated ablated(const std::string& name, const FastOptions& options, double h = 0.25) {
  constexpr long steps = 10;
  const Scene scene = smooth_scene(17);
  const Matrix expected =
      integrated(*made(integrator_entry(name), *scene.flow), scene.initial, h, steps);
  Matrix W = scene.initial;
  const RunReport report =
      run(*made(fast_entry(name, options), *scene.flow, options.iteration), W, h, steps);
  EXPECT_TRUE(report.converged());
  EXPECT_LE(spectrum_error(W, scene.initial), 1e-14);
  return {report.work, report.sweeps, (W - expected).norm() / expected.norm()};
}

struct Part {
  const char* name;
  void (*leave_out)(FastOptions& options);
};
const Part explicit_start = {"explicit_start", [](FastOptions& o) { o.explicit_start = false; }};
const Part error_estimates = {"error_estimates", [](FastOptions& o) { o.error_estimates = false; }};
const Part graded_series = {"graded_series", [](FastOptions& o) { o.graded_series = false; }};

TEST(Ablation, TheAnswerIsThePublishedOneToTheTolerance) {
  FastOptions nothing = complete;
  nothing.newton = false;
  nothing.past_steps = 0;
  for (const Part& part : {explicit_start, error_estimates, graded_series}) {
    FastOptions options = complete;
    part.leave_out(options);
    part.leave_out(nothing);
    for (const char* name : {"elp2", "elp4", "elp6", "magnus5"}) {
      EXPECT_LE(ablated(name, options).difference, 1e-6) << name << ' ' << part.name;
    }
  }
  for (const char* name : {"elp2", "elp4", "elp6", "magnus5"}) {
    EXPECT_LE(ablated(name, nothing).difference, 1e-6) << name;
  }
}

// The Munthe-Kaas form leaves out a part of the error of its steps, by the precision of terms where
// its series go on to rounding.
TEST(Ablation, TheMuntheKaasFormIsAsNearToThePublishedOne) {
  const double difference = ablated("rkmk4", complete).difference;
  FastOptions options = complete;
  options.graded_series = false;
  EXPECT_LE(ablated("rkmk4", options).difference, 2.0 * difference);
  EXPECT_GT(difference, 1e-12) << "the control";
}

TEST(Ablation, ItTakesMoreWork) {
  FastOptions cold = complete;
  cold.past_steps = 0;
  cold.explicit_start = false;
  for (const char* name : {"elp2", "elp4", "elp6"}) {
    const Ablated all = ablated(name, complete);
    const auto without = [&](const Part& part) {
      FastOptions options = complete;
      part.leave_out(options);
      return ablated(name, options);
    };
    // A cold start leaves more to do, and an unused estimate one more sweep.
    EXPECT_GT(ablated(name, cold).sweeps, all.sweeps) << name;
    EXPECT_GE(without(error_estimates).sweeps, all.sweeps + (name == std::string("elp2") ? 1 : 8))
        << name;
    EXPECT_GT(without(graded_series).work.equivalent_products, 1.1 * all.work.equivalent_products)
        << name;
  }
  const Work all = ablated("rkmk4", complete).work;
  FastOptions options = complete;
  options.graded_series = false;
  EXPECT_GT(ablated("rkmk4", options).work.equivalent_products, 1.1 * all.equivalent_products);
  // Single precision, from a tolerance of 1e-6 on, halves the products of Ω.
  const auto of_magnus = [](double tolerance) {
    return ablated("magnus5", {.iteration = {.tolerance = tolerance}}).work.equivalent_products;
  };
  EXPECT_GT(of_magnus(0.99e-6), 1.3 * of_magnus(1e-6));
}

TEST(Ablation, FormsThatDoNotUseItAreTheSameBitForBit) {
  const Scene scene = smooth_scene(17);
  FastOptions options;
  for (const Part& part : {explicit_start, error_estimates, graded_series}) {
    part.leave_out(options);
  }
  for (const char* name : {"group2", "algebra1", "rk4"}) {
    EXPECT_TRUE(integrated(*made(fast_entry(name, options), *scene.flow), scene.initial, 0.1, 5) ==
                integrated(*made(fast_entry(name), *scene.flow), scene.initial, 0.1, 5))
        << name;
  }
}

// ---- the choice of start values

TEST(StartChoice, TakesWhatHasTheSmallerErrorAndTriesTheOtherNowAndThen) {
  StartChoice choice;
  EXPECT_FALSE(choice.prefers_past());
  int steps = 0;
  for (; !choice.is_trial_due(); ++steps) choice.record_explicit(1e-5);
  EXPECT_GT(steps, 1);
  choice.record_past(1e-3);
  EXPECT_FALSE(choice.prefers_past());
  EXPECT_FALSE(choice.is_trial_due());
  choice.record_past(1e-6);
  EXPECT_TRUE(choice.prefers_past());
  choice.record_past(std::nan(""));
  EXPECT_FALSE(choice.prefers_past());
  choice.record_past(1e-6);
  choice.record_failure_of_past();
  EXPECT_FALSE(choice.prefers_past());
  choice.record_past(1e-6);
  choice.forget();
  EXPECT_FALSE(choice.prefers_past());
}

// ---- acceptance

TEST(Acceptance, BelievesAnEstimateNearTheSolutionAndFurtherOffWhereItWasConfirmed) {
  const Acceptance by_estimate = {.by = Acceptance::By::error_estimate};
  const Acceptance by_change;
  EXPECT_TRUE(by_estimate.accepts({.change = 1e-6, .error = 1e-9, .is_confirmed = false}, 1e-8));
  EXPECT_FALSE(by_change.accepts({.change = 1e-6, .error = 1e-9, .is_confirmed = true}, 1e-8));
  EXPECT_FALSE(by_estimate.accepts({.change = 1e-4, .error = 1e-9, .is_confirmed = false}, 1e-8));
  EXPECT_TRUE(by_estimate.accepts({.change = 1e-4, .error = 1e-9, .is_confirmed = true}, 1e-8));
  EXPECT_FALSE(by_estimate.accepts({.change = 1e-2, .error = 1e-9, .is_confirmed = true}, 1e-8));
  EXPECT_FALSE(by_estimate.accepts({.change = 1e-6, .error = 1e-7, .is_confirmed = true}, 1e-8));
  const double nan = std::nan("");
  EXPECT_FALSE(by_estimate.accepts({.change = 1e-6, .error = nan, .is_confirmed = true}, 1e-8));
  EXPECT_FALSE(by_estimate.accepts({.change = nan, .error = nan, .is_confirmed = true}, 1e-8));
}

// ---- the Jacobian

// A correction δ of a system at its solution: (1 - G') δ = R by differences of G.
class ExponentialJacobian : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, ExponentialJacobian, ::testing::Values(2, 4, 6));

TEST_P(ExponentialJacobian, SolvesForTheCorrection) {
  constexpr Index n = 9;
  for (const bool is_rough : {false, true}) {
    const Scene scene = is_rough ? rough_scene(n) : smooth_scene(n);
    Matrix B(n, n);
    scene.flow->generator(scene.initial, B);
    for (const double sign : {1.0, -1.0}) {
      ExponentialSystem system(*scene.flow, GetParam());
      const auto memory = system.memory();
      const SplitMatrix W0(scene.initial);
      system.bind(W0, sign * 0.5 / spectral_norm(B), 1e-13, *memory);
      Unknowns x = system.unknowns();
      system.start(x, Start::cold);
      Corrections R = corrections_like(x), delta = R;
      for (int k = 0; k < 60; ++k) {
        system.residual(R, x, 1e-14);
        add(x, R);
      }
      EXPECT_LE(system.residual(R, x, 1e-14).change, 1e-13);

      const auto residual_at = [&](const Matrix& moved) {
        Unknowns y = {{SplitMatrix(Matrix(x[0][0].interleaved() + moved))}};
        system.residual(R, y, 1e-14);
        return R[0][0].interleaved();
      };
      const Matrix wanted = random_skew_hermitian(n, 3);  // the R of the correction
      const double size = wanted.norm();
      // How far δ is from solving, beside R: G' by central differences, which err by e².
      const auto error_of = [&](const Matrix& d) {
        constexpr double e = 1e-4;
        const Matrix minus_R = 0.5 / e * (residual_at(e * d) - residual_at(-e * d));  // (G' - 1) δ
        return (minus_R + wanted).norm() / size;
      };
      for (const double forcing : {1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6}) {
        system.residual(R, x, 1e-14);
        R[0][0].load(wanted);
        const Correction found =
            system.correct(delta, x, R, {.size = size, .forcing_term = forcing * size}, {});
        EXPECT_TRUE(found.usable);
        const double error = error_of(delta[0][0].interleaved());
        // Terms of series that are left out may err by a few times the rest.
        EXPECT_LE(error, 4.0 * found.error / size) << forcing;
        // The derivative of the term in h⁴ is left out: 1e-5 here.
        EXPECT_LE(error, 2.5 * forcing + (GetParam() == 6 ? 2e-5 : 0.0)) << forcing;
      }
      // The control: δ = R is no solution.
      EXPECT_GT(error_of(wanted), 1e-2);
    }
  }
}

// The derivative of the term in h² is left out of a correction that may err by more.
TEST(ExponentialSystems, TakeADerivativeOnlyWhereTheErrorAsksForIt) {
  constexpr Index n = 9;
  const Scene scene = rough_scene(n);
  Matrix B(n, n);
  scene.flow->generator(scene.initial, B);
  // Poisson solves of a correction: 1 for K δ and 3 for E δ.
  const auto solves_for = [&](int order, double forcing) {
    ExponentialSystem system(*scene.flow, order);
    const auto memory = system.memory();
    const SplitMatrix W0(scene.initial);
    system.bind(W0, 0.5 / spectral_norm(B), 1e-13, *memory);
    Unknowns x = system.unknowns();
    system.start(x, Start::stepped);
    Corrections R = corrections_like(x), delta = R;
    const Matrix wanted = random_skew_hermitian(n, 3);
    system.residual(R, x, 1e-14);
    R[0][0].load(wanted);
    const long before = system.work().poisson_solves;
    const CorrectionRequest request = {.size = wanted.norm(),
                                       .forcing_term = forcing * wanted.norm()};
    EXPECT_TRUE(system.correct(delta, x, R, request, {}).usable);
    return system.work().poisson_solves - before;
  };
  // E δ is 7e-3 of δ at most, as far as is known.  The method of order 2 has no such term.
  EXPECT_EQ(solves_for(4, 3e-2), solves_for(2, 3e-2));
  EXPECT_GE(solves_for(4, 1e-4), solves_for(2, 1e-4) + 3);
}

// The gradient of the modified Hamiltonian, and the derivative of its first term.
TEST(ModifiedGradient, IsTheSumOfItsTermsAndHasTheDerivativeThatItSays) {
  constexpr Index n = 8;
  const Scene scene = rough_scene(n);
  SplitProducts products(n);
  StageGenerator generator(*scene.flow);
  BandTruncation bands(false, 1, n);
  SplitLie<double> lie(products, generator, bands);
  ModifiedGradient<SplitLie<double>> gradient(lie, 6);
  const auto evaluated = [&](const Matrix& mu, bool second, bool fourth) {
    SplitMatrix v(n), out(n);
    lie.generate(v, SplitMatrix(mu));
    gradient.evaluate(out, SplitMatrix(mu), v, 0.7, {.second = second, .fourth = fourth});
    return out.interleaved();
  };
  const Matrix mu = scene.initial;
  const Matrix both = evaluated(mu, true, true), second = evaluated(mu, true, false),
               fourth = evaluated(mu, false, true);
  EXPECT_LE(largest_difference(both, second + fourth), 1e-15);
  EXPECT_GT(fourth.norm(), 1e-6);

  const Matrix D = random_skew_hermitian(n, 4);
  SplitMatrix v(n), BD(n), out(n);
  lie.generate(v, SplitMatrix(mu));
  lie.generate(BD, SplitMatrix(D));
  gradient.linearize(SplitMatrix(mu), v);
  gradient.derivative_of_second(out, SplitMatrix(mu), v, SplitMatrix(D), BD, 0.7);
  constexpr double e = 1e-4;  // the term is cubic in μ: central differences err by e²
  const Matrix difference =
      0.5 / e * (evaluated(mu + e * D, true, false) - evaluated(mu - e * D, true, false));
  EXPECT_LE((difference - out.interleaved()).norm(), 1e-7 * out.interleaved().norm());
  EXPECT_GT(out.interleaved().norm(), 1e-3);
}

// ---- series and exponentials

// e^Ω W e^(-Ω) by Eigen's exponential.
Matrix conjugated(const Matrix& W, const Matrix& Omega) {
  const Matrix Q = exponential(Omega);
  return product({Q, W, Q.adjoint()});
}

TEST(SplitExponential, ConjugatesToRoundingForEveryLengthOfItsSeriesAndRefusesLongerOnes) {
  for (const Index n : {2, 6, 50}) {
    SplitProducts products(n);
    SingleProducts single_products(n);
    const Matrix W = random_skew_hermitian(n, 2);
    for (const bool has_bands : {false, true}) {
      BandTruncation bands(has_bands, 1, n);
      SplitExponential of(n, bands);
      for (const double size : {0.0, 1e-9, 0.05, 0.2, 0.5, 1.0, 1.7, 3.0, 4.0}) {
        SCOPED_TRACE(::testing::Message() << n << " " << has_bands << " " << size);
        // With and without entries that fall off from the diagonal.
        for (const double rate : {0.0, 1.0}) {
          Matrix Omega = random_skew_hermitian(n, 1);
          for (Index r = 0; r < n; ++r) {
            for (Index c = 0; c < n; ++c) {
              Omega(r, c) *= std::exp(-rate * static_cast<double>(std::abs(r - c)));
            }
          }
          Omega *= size / spectral_norm(Omega);
          SplitMatrix W1(n), adjoint(n);
          ASSERT_TRUE(of.conjugate(W1, adjoint, SplitMatrix(Omega), SplitMatrix(W), 0.0, products,
                                   single_products));
          EXPECT_LE((W1.interleaved() - conjugated(W, Omega)).norm(), 1e-14 * (1.0 + size));
          EXPECT_LE(spectrum_error(W1.interleaved(), W), 1e-14);
          EXPECT_EQ(skew_defect(W1.interleaved()), 0.0);
          if (size > 0.0) {  // the control: another Ω is seen
            EXPECT_GT((W1.interleaved() - conjugated(W, -Omega)).norm(), 1e-3 * size);
          }
        }
      }
      SplitMatrix W1(n), adjoint(n);
      const Matrix unit = random_skew_hermitian(n, 1);
      for (const double size : {20.0, 1e10, 1e200, std::nan("")}) {
        EXPECT_FALSE(of.conjugate(W1, adjoint, SplitMatrix(Matrix(size * unit)), SplitMatrix(W),
                                  0.0, products, single_products));
      }
    }
  }
}

// The state of a smooth scene and the exponent of a step of it, with the bands that smooth scenes
// have.
TEST(SplitExponential, WithAnErrorAllowedStaysUnitaryToRoundingAndMultipliesLess) {
  constexpr Index n = 97;
  const auto falling = [](Matrix W, double rate) {
    for (Index r = 0; r < n; ++r) {
      for (Index c = 0; c < n; ++c)
        W(r, c) *= std::exp(-rate * static_cast<double>(std::abs(r - c)));
    }
    return W;
  };
  const Matrix W = falling(random_skew_hermitian(n, 2), 0.5);
  Matrix Omega = falling(random_skew_hermitian(n, 1), 0.7);
  Omega *= 2.0 / spectral_norm(Omega);
  const Matrix expected = conjugated(W, Omega);
  BandTruncation bands(true, 1, n);
  SplitExponential of(n, bands);
  SingleProducts single_products_to_transport(n);
  double work_to_rounding = 0.0;
  for (const double error : {0.0, 1e-11, 1e-9, 1e-6, 1e-2}) {
    SCOPED_TRACE(error);
    SplitProducts products(n);
    SingleProducts single_products(n);
    SplitMatrix Omega_cut(Omega), W1(n), adjoint(n);
    bands.truncate(Omega_cut, std::min(error, 1e-9));
    ASSERT_TRUE(
        of.conjugate(W1, adjoint, Omega_cut, SplitMatrix(W), error, products, single_products));
    const double found = (W1.interleaved() - expected).norm() / W.norm();
    EXPECT_LE(found, 2.0 * error + 1e-15);
    EXPECT_LE(spectrum_error(W1.interleaved(), W), 1e-14 * W.norm());
    EXPECT_EQ(skew_defect(W1.interleaved()), 0.0);
    SingleMatrix W_single(n), transported(n);
    round_to_single(W_single, SplitMatrix(W));
    of.transport(transported, adjoint, W_single, single_products_to_transport);
    EXPECT_LE((transported.interleaved().cast<Complex>() - expected).norm() / W.norm(),
              2.0 * error + 2e-3);
    const double work = products.equivalents() + 0.5 * single_products.equivalents();
    if (error == 0.0) {
      work_to_rounding = work;
    } else {
      EXPECT_GT(found, 1e-14);  // the control: there is an error to be seen
      EXPECT_LT(work, 0.8 * work_to_rounding);
    }
  }
}

TEST(GradedSeries, ErrsByAboutTheWantedErrorAndUsesSinglePrecisionWhereThatIsEnough) {
  constexpr Index n = 20;
  const Matrix W = random_skew_hermitian(n, 2), Omega = 0.8 * random_skew_hermitian(n, 1);
  const Matrix expected = conjugated(W, Omega);
  double last = 0.0;
  for (const double error : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    SplitProducts products(n);
    SingleProducts single_products(n);
    GradedSeries series(products, single_products, n);
    SplitMatrix out(n);
    ASSERT_TRUE(series.conjugate(out, SplitMatrix(Omega), SplitMatrix(W), error));
    const double found = (out.interleaved() - expected).norm();
    EXPECT_LE(found, 3.0 * error + 1e-14) << error;
    EXPECT_GT(single_products.count(), 0) << error;
    if (error >= 1e-12) {
      EXPECT_GT(found, 1e-4 * error) << "no digits that were not asked for";
    }
    const double work =
        static_cast<double>(products.count()) + 0.5 * static_cast<double>(single_products.count());
    EXPECT_GT(work, last) << error;
    last = work;
  }
}

// φ₁(ad_Ω) W to this error takes fewer terms than e^Ω W e^(-Ω), since T_k counts by 1/(k+1).
TEST(GradedSeries, AveragesToAboutTheWantedErrorInFewerTerms) {
  constexpr Index n = 20;
  const Matrix W = random_skew_hermitian(n, 2), Omega = 0.8 * random_skew_hermitian(n, 1);
  Matrix expected = W, T = W;
  for (int k = 1; k < 100; ++k) {
    T = ((Omega * T - T * Omega) / static_cast<double>(k)).eval();
    expected += T / static_cast<double>(k + 1);
  }
  for (const double error : {1e-3, 1e-6, 1e-9, 1e-12}) {
    std::array<int, 2> terms{};
    for (const bool averages : {false, true}) {
      SplitProducts products(n);
      SingleProducts single_products(n);
      GradedSeries series(products, single_products, n);
      SplitMatrix sum(W);
      series.begin(SplitMatrix(Omega), SplitMatrix(W), error,
                   averages ? GradedSeries::Sum::average : GradedSeries::Sum::conjugate);
      bool goes_on = true;
      while (goes_on) {
        goes_on = series.advance();
        ASSERT_FALSE(series.failed());
        series.add_upper_to({&sum, 1.0 / static_cast<double>(series.k() + 1)});
      }
      mirror_skew_in_band(sum);
      EXPECT_LE((sum.interleaved() - expected).norm(), 3.0 * error + 1e-14) << error;
      terms[averages ? 1 : 0] = series.k();
    }
    EXPECT_LT(terms[1], terms[0]) << error;
  }
}

// Near a relative equilibrium W commutes with Ω almost: T₁ is small, but T₂ and later ones are not
// smaller yet.  A series that took T₂ / T₁ for T₁ / T₀ would end at T₁.
TEST(GradedSeries, IsNotEndedByATermThatIsSmallByChance) {
  constexpr Index n = 20;
  const Matrix Omega = 0.8 * random_skew_hermitian(n, 1);
  const Matrix W = Omega + 1e-3 * random_skew_hermitian(n, 2);
  SplitProducts products(n);
  SingleProducts single_products(n);
  GradedSeries series(products, single_products, n);
  SplitMatrix out(n);
  constexpr double error = 1e-6;
  ASSERT_TRUE(series.conjugate(out, SplitMatrix(Omega), SplitMatrix(W), error));
  EXPECT_LE((out.interleaved() - conjugated(W, Omega)).norm(), 3.0 * error);
  // The control: what T₀ + T₁ lacks.
  const Matrix two_terms = W + Omega * W - W * Omega;
  EXPECT_GT((two_terms - conjugated(W, Omega)).norm(), 100.0 * error);
}

TEST(TermGrowth, ForetellsATermOnceTwoWereSeenAndNeverTooSmallWhereGrowthSlows) {
  TermGrowth growth;
  growth.begin(2.0);
  EXPECT_EQ(growth.next(1.0), std::numeric_limits<double>::infinity());
  growth.record(3.0, 0.5);  // grew threefold
  EXPECT_EQ(growth.next(0.5), std::numeric_limits<double>::infinity());
  growth.record(4.0, 1.0 / 3.0);                                   // fourfold
  EXPECT_NEAR(growth.next(0.25), 0.25 * 4.0 * 16.0 / 3.0, 1e-14);  // 16/3 at most
  growth.begin(1.0);
  EXPECT_EQ(growth.next(1.0), std::numeric_limits<double>::infinity()) << "of the new series";
}

// The terms and Ω are cut to bands: the sum of all cuts is about the tail.
TEST(GradedSeries, WithBandsErrsByAboutTheTailAndMultipliesLess) {
  constexpr Index n = 40;
  const auto falling_off = [](Matrix W) {
    for (Index r = 0; r < n; ++r) {
      for (Index c = 0; c < n; ++c) W(r, c) *= std::exp(-static_cast<double>(std::abs(r - c)));
    }
    return W;
  };
  const Matrix W = falling_off(random_skew_hermitian(n, 2));
  const Matrix Omega = falling_off(0.8 * random_skew_hermitian(n, 1));
  const Matrix expected = conjugated(W, Omega);
  const auto run_with = [&](double tail) {
    SplitProducts products(n);
    SingleProducts single_products(n);
    BandTruncation bands(true, 1, n);
    GradedSeries series(products, single_products, n);
    series.truncate(bands, tail);
    SplitMatrix out(n);
    EXPECT_TRUE(series.conjugate(out, SplitMatrix(Omega), SplitMatrix(W), 1e-14));
    return std::pair((out.interleaved() - expected).norm(), products.equivalents());
  };
  double last = std::numeric_limits<double>::infinity();
  for (const double tail : {0.0, 1e-12, 1e-8, 1e-4}) {
    const auto [error, products] = run_with(tail);
    // Twenty terms are cut, each twice, and what is cut goes through the rest of the series.
    EXPECT_LE(error, 100.0 * tail + 1e-13) << tail;
    EXPECT_LT(products, last) << tail;
    if (tail > 0.0) {
      EXPECT_GT(error, 1e-2 * tail) << "nothing was cut";
    }
    last = products;
  }
}

// B(W) of a W within a band, in a matrix that held something wider or narrower before.
TEST(StageGenerators, FormTheGeneratorOfOneMatrixWithinItsBand) {
  constexpr Index n = 33;
  const auto euler = std::make_shared<const EulerZeitlin>(n);
  CoRotatingFrame frame(euler);
  for (const Flow* flow : {static_cast<const Flow*>(euler.get()), frame.flow().get()}) {
    StageGenerator generator(*flow);
    for (const Index band : {Index{0}, Index{1}, Index{7}, n - 1}) {
      const Matrix W = entries_of(random_skew_hermitian(n, 4),
                                  [band](Index r, Index c) { return std::abs(r - c) <= band; });
      Matrix expected(n, n);
      flow->generator(W, expected);
      for (const Index before : {Index{0}, Index{20}, n - 1}) {
        SplitMatrix B(entries_of(random_skew_hermitian(n, 5),
                                 [before](Index r, Index c) { return std::abs(r - c) <= before; }));
        B.set_band(before);
        SplitMatrix argument(W);
        argument.set_band(band);
        generator.generate_one(B, argument);
        EXPECT_LE(largest_difference(B.interleaved(), expected), 1e-14) << band << ' ' << before;
        EXPECT_EQ(B.band(), std::max<Index>(band, 1));

        SingleMatrix B_single(n), single(n);
        round_to_single(B_single, B);
        round_to_single(single, argument);
        generator.generate_one(B_single, single);
        EXPECT_LE(largest_difference(B_single.interleaved(), expected), 1e-6) << band;
      }
    }
  }
}

TEST(GradedSeries, FailsWhereItsTermsAreNotFinite) {
  constexpr Index n = 5;
  SplitProducts products(n);
  SingleProducts single_products(n);
  GradedSeries series(products, single_products, n);
  const Matrix W = random_skew_hermitian(n, 2);
  SplitMatrix out(n);
  for (const double size : {1e4, 1e200, std::nan("")}) {
    const Matrix Omega = size * random_skew_hermitian(n, 1);
    EXPECT_FALSE(series.conjugate(out, SplitMatrix(Omega), SplitMatrix(W), 1e-10)) << size;
  }
  EXPECT_TRUE(
      series.conjugate(out, SplitMatrix(random_skew_hermitian(n, 1)), SplitMatrix(W), 1e-10))
      << "and works afterwards";
}

// ---- the error of explicit start values

// The error of the explicit start values of steps in a row: each step turns it by e^A and moves it
// by a hundredth.
class StartErrors : public ::testing::Test {
 protected:
  static constexpr Index n = 20;

  // Takes a step, with errors transported by e^turn.  Returns the error of its start values with
  // what was foretold, over the error without.
  double left_of_error(StartError& errors, const Matrix& turn) {
    SplitMatrix x(Omega - E);
    errors.add_expected(x, [&](SingleMatrix& out, const SingleMatrix& X) {
      round_to_single(out, SplitMatrix(conjugated(X.interleaved().cast<Complex>(), turn)));
    });
    const double left = (x.interleaved() - Omega).norm() / E.norm();
    errors.record(SplitMatrix(Omega));
    E = conjugated(E, A) + moved;
    return left;
  }

  Matrix Omega = random_skew_hermitian(n, 1);
  Matrix E = 1e-4 * random_skew_hermitian(n, 2);
  Matrix moved = 1e-6 * random_skew_hermitian(n, 3);
  Matrix A = 0.3 * random_skew_hermitian(n, 4);
};

TEST_F(StartErrors, AreForetoldAsTheyAreTransported) {
  StartError errors(n);
  EXPECT_NEAR(left_of_error(errors, A), 1.0, 1e-9) << "nothing is known yet";
  EXPECT_NEAR(left_of_error(errors, A), 1e-2, 3e-3);
  EXPECT_NEAR(left_of_error(errors, A), 1e-2, 3e-3);
  EXPECT_GT(left_of_error(errors, 0.0 * A), 0.1) << "the control: not transported";
}

TEST_F(StartErrors, AreNotForetoldWhereTheyAreSmallOrNotOfTheStepBefore) {
  StartError errors(n);
  left_of_error(errors, A);
  EXPECT_LT(left_of_error(errors, A), 0.1) << "the control";
  errors.forget();
  EXPECT_NEAR(left_of_error(errors, A), 1.0, 1e-9);
  EXPECT_LT(left_of_error(errors, A), 0.1) << "the control";
  errors.record(SplitMatrix(Omega));  // of a step that started otherwise
  EXPECT_NEAR(left_of_error(errors, A), 1.0, 1e-9);
  SplitMatrix x(Omega);
  errors.add_expected(x, [](SingleMatrix&, const SingleMatrix&) {});
  errors.forget();                    // the step failed
  errors.record(SplitMatrix(Omega));  // and the next one started otherwise
  EXPECT_NEAR(left_of_error(errors, A), 1.0, 1e-9);
  moved.setZero();
  E *= 5e-7 * Omega.norm() / E.norm();  // rounding to single precision leaves as much
  left_of_error(errors, A);
  EXPECT_NEAR(left_of_error(errors, A), 1.0, 1e-6);
}

// The first change of a step is the error of its start values.
TEST(StartError, IsMostlyForetoldInARun) {
  const Scene scene = rough_scene(33);
  bool steps_beside = false;  // another state takes a step too
  const auto error_of_last_start = [&](const char* name, double h, const FastOptions& options,
                                       long steps) {
    const auto method = made(fast_entry(name, options), *scene.flow, options.iteration);
    method->set_state(scene.initial);
    StepReport report;
    for (long k = 0; k < steps; ++k) {
      Matrix other = scene.initial.reverse();
      if (steps_beside) method->step(other, h);
      report = method->step(h);
    }
    EXPECT_EQ(report.sweeps, 1);
    return report.last_change;
  };
  for (const auto& [name, h] : {std::pair("elp4_frame", 5.0 / 14.0), {"elp6_frame", 5.0 / 8.0}}) {
    const double first = error_of_last_start(name, h, complete, 1);
    EXPECT_LT(error_of_last_start(name, h, complete, 2), 0.2 * first) << name;
    EXPECT_LT(error_of_last_start(name, h, complete, 5), 0.15 * first) << name;
  }
  const double alone = error_of_last_start("elp4_frame", 5.0 / 14.0, complete, 4);
  steps_beside = true;
  EXPECT_EQ(error_of_last_start("elp4_frame", 5.0 / 14.0, complete, 4), alone)
      << "what the other state showed is not taken";
}

}  // namespace
}  // namespace isosyrk::testing
