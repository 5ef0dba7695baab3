#include "isosyrk/fast/exponential_equation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// Error of μ, relative to ‖W₀‖, as a multiple of the accuracy of Ω: B damps the fine scales, where
// most of it lies.  At two fifths of this value steps take 1 to 2 % more products, and the solver's
// part in the energy of long runs stays the same (n = 33, h = 0.5, smooth and rough).
constexpr double error_of_average_of_unit = 5.0;
// Parts of the accuracy that may be cut from Ω, and from the terms of its series.
constexpr double part_cut = 0.1;

}  // namespace

ExponentialEquation::ExponentialEquation(SplitOperations& operations, const ExponentialStep& step,
                                         int order, const FastOptions& options)
    : operations_(operations),
      step_(step),
      series_(operations.products, operations.single_products, operations.size(), options),
      gradient_(operations.lie, operations.single_lie, operations.size(), order),
      mu_(operations.size()),
      v_(operations.size()) {}

void ExponentialEquation::start_cold(SplitMatrix& Omega) {
  operations_.lie.neglect(0.0);
  operations_.lie.generate(Omega, *step_.W0);
  Omega = step_.h * Omega;
}

ResidualSize ExponentialEquation::residual(SingleStages& R, SplitStages& Omega, AtNodes& states,
                                           double accuracy) {
  const double h = step_.h;
  const double relative = accuracy / step_.unit(Omega[0]);
  operations_.bands.truncate(Omega, part_cut * accuracy);
  const double error = error_of_average_of_unit * relative * step_.size_of_W0;
  if (!form_average(states, Omega[0], error)) {
    return {.change = std::numeric_limits<double>::quiet_NaN(), .neglected = 0.0};
  }
  gradient_.evaluate(v_, mu_, Omega[0],
                     {.h = h, .accuracy = relative, .least = step_.least_unit / std::abs(h)});
  const double change = form_residual(
      R, [&](std::size_t) { return h * v_; }, Omega);
  return {.change = change, .neglected = 0.5 * accuracy};
}

// Sets μ with this error, and the states at the nodes.  Returns false if the series fails.
bool ExponentialEquation::form_average(AtNodes& states, const SplitMatrix& Omega, double error) {
  mu_ = 1.0 * *step_.W0;
  for (SingleMatrix& state : states) state = 1.0 * step_.W0_single;
  series_.truncate(operations_.bands, part_cut * error);
  series_.begin(Omega, *step_.W0, error, GradedSeries::Sum::average);
  bool goes_on = true;
  while (goes_on) {
    goes_on = series_.advance();
    if (series_.failed()) return false;
    add_term(states);
  }
  mirror_skew_in_band(mu_);
  for (SingleMatrix& state : states) mirror_skew_in_band(state);
  return true;
}

// μ += T_k / (k+1), and e^{s ad_Ω} W₀ += s^k T_k.
void ExponentialEquation::add_term(AtNodes& states) {
  const int k = series_.k();
  const std::array<Addition<float>, 2> to_states = {
      {{&states[0], std::pow(coupling_nodes[0].s, k)},
       {&states[1], std::pow(coupling_nodes[1].s, k)}}};
  series_.add_upper_to({&mu_, 1.0 / static_cast<double>(k + 1)}, to_states);
}

}  // namespace isosyrk
