// Linear theory of the iteration, against the iteration itself with a frozen generator, where it is
// exact.
#include "isosyrk/integrators/step_limits.h"

#include "isosyrk/flows/invariants.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// W' = [B, W] with a constant B.
FlowOf frozen_flow(const Matrix& B) {
  return {QuadraticAlgebra::skew_hermitian(B.rows()), [B](const Matrix&, Matrix& out) { out = B; }};
}

class LinearLimit : public ::testing::TestWithParam<IntegratorEntry> {
 protected:
  const Matrix B = random_skew_hermitian(7, 1);
  const Matrix W0 = random_skew_hermitian(7, 2);
  const FlowOf flow = frozen_flow(B);
  const double limit = GetParam().linear_limit(spectrum(B));
};

class IterationLimit : public LinearLimit {};

TEST_P(IterationLimit, BelowItTheIterationContractsAndBeyondItFails) {
  // Changes grow before they fall, the more the more stages there are (h ‖A‖ > 1), and rounding
  // with them: from 7 stages on it ends above 1e-13.
  const double tolerance = GetParam().order > 12 ? 1e-12 : 1e-13;
  const auto step = [&](double h) {
    Matrix W = W0;
    return made(GetParam(), flow, {tolerance, 3000})->step(W, h);
  };
  const StepReport report = step(0.9 * limit);
  EXPECT_EQ(report.status, Status::converged);
  // Changes fall from about 1 to the tolerance; the modulus of the slowest entry goes like h, or h²
  // for the product term of the midpoint.
  const double mean_contraction = std::pow(tolerance, 1.0 / report.sweeps);
  EXPECT_LT(mean_contraction, 0.98);
  EXPECT_GT(mean_contraction, 0.9 * 0.9 - 0.05);
  EXPECT_NE(step(1.05 * limit).status, Status::converged);
}

// Of explicit methods.
class StepLimit : public LinearLimit {};

TEST_P(StepLimit, BelowItNothingGrowsAndBeyondItPerturbationsDo) {
  const auto growth = [this](double h) {
    Matrix W = W0;
    run(*made(GetParam(), flow), W, h, 500);
    return W.norm() / W0.norm();
  };
  EXPECT_LE(growth(0.99 * limit), 1.0 + 1e-10);
  // Beyond, rk5 and rk10 grow by less than a thousandth a step for a while, and what grows in abm8
  // begins at rounding.
  const bool at_once =
      GetParam().family == Family::runge_kutta && (GetParam().order == 4 || GetParam().order == 8);
  EXPECT_GT(growth((at_once ? 1.05 : 2.5) * limit), 100.0);
}

std::vector<IntegratorEntry> limited(bool is_explicit) {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.co_rotating) continue;  // for Euler-Zeitlin only
    if (entry.linear_limit && entry.is_explicit == is_explicit) found.push_back(entry);
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(All, IterationLimit, ::testing::ValuesIn(limited(false)),
                         ::testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(All, StepLimit, ::testing::ValuesIn(limited(true)),
                         ::testing::PrintToStringParamName());

// The largest (x_p - x_q)² + (x_p x_q)² over the entries, x = hβ/2: the squared spectral radius of
// the midpoint's sweep.  Random numbers of both signs, where the first term is largest, and
// frequencies close to one another, where the second is.
TEST(MidpointLimit, IsWhereTheSpectralRadiusIsOne) {
  const auto squared_radius = [](double h, const RealVector& frequencies) {
    double largest = 0.0;
    for (const double p : frequencies) {
      for (const double q : frequencies) {
        const double x = h * p / 2.0, y = h * q / 2.0;
        largest = std::max(largest, (x - y) * (x - y) + x * x * y * y);
      }
    }
    return largest;
  };
  for (const RealVector& frequencies :
       {spectrum(random_skew_hermitian(7, 1)), spectrum(random_skew_hermitian(17, 2)),
        RealVector(RealVector::LinSpaced(5, -1.0, 3.0)),
        RealVector(RealVector::LinSpaced(5, 1.0, 1.1)), RealVector(RealVector::Constant(1, 0.7))}) {
    const double limit = midpoint_iteration_limit(frequencies);
    EXPECT_NEAR(squared_radius(limit, frequencies), 1.0, 1e-12);
    EXPECT_GT(squared_radius(1.001 * limit, frequencies), 1.001);
    EXPECT_LT(squared_radius(0.999 * limit, frequencies), 0.999);
  }
}

// Each entry (p, q) of a Hermitian part takes an Euler step with the frequency β_p - β_q.  Rounding
// starts all of them; after many steps only the fastest, of frequency ‖ad_B‖₂, is seen.
TEST(TwoProductsUpdate, LetsTheHermitianPartGrowAsTheEulerMethodDoes) {
  const Matrix B = random_skew_hermitian(7, 1);
  const FlowOf flow = frozen_flow(B);
  const RealVector frequencies = spectrum(B);
  const double h = 0.2 / (frequencies.maxCoeff() - frequencies.minCoeff());
  const double growth = 0.5 * std::log1p(0.2 * 0.2);
  const long steps = std::lround(8.0 / growth);
  for (const IntegratorEntry& entry :
       {two_products_entry(2), two_products_entry(3), gauss_entry(Formulation::algebra, 2)}) {
    const auto integrator = made(entry, flow);
    Matrix W = random_skew_hermitian(7, 2);
    run(*integrator, W, h, steps);
    const double early = (W + W.adjoint()).norm();
    run(*integrator, W, h, steps);
    const double late = (W + W.adjoint()).norm();
    if (entry.keeps.isospectral) {
      EXPECT_EQ(late, 0.0);
    } else {
      EXPECT_NEAR(std::log(late / early) / static_cast<double>(steps) / growth, 1.0, 0.1)
          << entry.name;
    }
  }
}

TEST(LinearLimits, OnlyTheExponentialHasNone) {
  for (const std::string& name : recorded_integrators()) {
    const IntegratorEntry& entry = integrator_entry(name);
    EXPECT_EQ(static_cast<bool>(entry.linear_limit), entry.family != Family::munthe_kaas) << name;
  }
}

}  // namespace
}  // namespace isosyrk::testing
