#include "isosyrk/solver/inexact_newton.h"

#include <algorithm>

#include "isosyrk/iteration/picard.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

void add_to(Unknowns& x, const Corrections& delta) {
  for (std::size_t kind = 0; kind < x.size(); ++kind) add(delta[kind], x[kind]);
}

void copy(const Corrections& from, Corrections& to) {
  for (std::size_t kind = 0; kind < to.size(); ++kind) {
    assign(to[kind], [&](std::size_t i) { return sum_of(1.0, from[kind][i]); });
  }
}

}  // namespace

InexactNewton::InexactNewton(const Unknowns& like)
    : sweeps_(tuning.sweeps_for_a_correction(like[0][0].size())),
      R_(corrections_like(like)),
      delta_(R_),
      rhs_(R_),
      coupled_(R_) {
  forget();
}

void InexactNewton::forget() { contraction_ = tuning.likely_contraction; }

SolveReport InexactNewton::newton(FixedPointSystem& system, const IterationOptions& options,
                                  Unknowns& x) {
  double uncorrected = 0.0;  // change of the last sweep if that was a Picard sweep, else 0
  return solve_fixed_point(options, [&] {
    const double change = system.residual(x, options.tolerance, R_);
    if (uncorrected > 0.0) contraction_ = change / uncorrected;
    // If the contraction predicts that a few Picard sweeps converge, no correction is computed.
    const double ahead = std::min(1.0, 2.0 * contraction_) * std::pow(contraction_, sweeps_ - 1);
    const bool sweeps_converge = ahead * change < options.tolerance;
    const bool corrected = !sweeps_converge && change <= tuning.largest_corrected &&
                           correct(system, R_, change, options);
    uncorrected = sweeps_converge ? change : 0.0;
    add_to(x, corrected ? delta_ : R_);
    return change;
  });
}

SolveReport InexactNewton::picard(FixedPointSystem& system, const IterationOptions& options,
                                  int frozen_sweeps, Unknowns& x) {
  return solve_fixed_point(options, [&] {
    const double change = system.residual(x, options.tolerance, R_);
    if (frozen_sweeps == 0 || !(change >= options.tolerance)) {
      add_to(x, R_);
      return change;
    }
    system.linearise(tuning.of_size);
    copy(R_, delta_);
    for (int k = 0; k < frozen_sweeps; ++k) {
      options.swept();
      system.frozen_sweep(R_, delta_);
    }
    add_to(x, delta_);
    return change;
  });
}

bool InexactNewton::correct(FixedPointSystem& system, const Corrections& R, double size,
                            const IterationOptions& options) {
  const double forcing_term =
      std::max({tuning.of_tolerance * options.tolerance, tuning.of_size * size,
                tuning.of_size_squared * size * size});
  system.linearise(tuning.of_forcing_term * forcing_term / size);
  copy(R, delta_);
  const Corrections* rhs = &R;
  double T_contraction = 0.0;
  double K_contraction = tuning.likely_contraction;
  double T_error = size;      // estimated error of delta as solution of delta = rhs + T delta
  double not_coupled = size;  // estimated norm of the part of delta to which K was not applied
  double last = size;
  bool coupled = false;
  // Alternates sweeps with T and K, always reducing the larger error estimate.
  for (int k = 0; k < tuning.inner_sweeps; ++k) {
    const double K_error = K_contraction * not_coupled;
    if (T_error + K_error < forcing_term) break;
    options.swept();
    if (k > 0 && K_error > T_error) {
      system.couple(delta_, coupled_);
      double shift = 0.0;
      for (std::size_t kind = 0; kind < delta_.size(); ++kind) {
        assign(coupled_[kind],
               [&](std::size_t i) { return sum_of(1.0, R[kind][i]).add(1.0, coupled_[kind][i]); });
        shift = larger(shift, replace(delta_[kind], [&](std::size_t i) {
                         return sum_of(1.0, delta_[kind][i])
                             .add(1.0, coupled_[kind][i])
                             .add(-1.0, (*rhs)[kind][i]);
                       }));
      }
      std::swap(rhs_, coupled_);
      rhs = &rhs_;
      last = shift;
      K_contraction = std::max(0.5 * K_contraction, last / not_coupled);
      not_coupled = last;
      T_error =
          system.solves_frozen() ? last : T_error + last * T_contraction / (1.0 - T_contraction);
      coupled = true;
    } else {
      const double now = system.frozen_sweep(*rhs, delta_);
      const double before = coupled ? last + T_error : last;
      if (!(now < tuning.growth * before)) return false;  // NaN included
      T_contraction = std::max(coupled ? T_contraction : 0.9 * T_contraction, now / before);
      T_contraction = std::min(T_contraction, 0.9);
      last = now;
      T_error = system.solves_frozen() ? 0.0 : now * T_contraction / (1.0 - T_contraction);
      not_coupled += now;
      coupled = false;
    }
  }
  return T_error + K_contraction * not_coupled < size;
}

}  // namespace isosyrk
