#include "isosyrk/solver/alternating_correction.h"

#include <algorithm>
#include <utility>

#include "isosyrk/linalg/matrix.h"
#include "isosyrk/solver/tuning.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// Estimated errors of delta, from the changes of delta by frozen sweeps and couplings.
class InnerErrors {
 public:
  // R, of norm `size`, is the first delta.
  InnerErrors(double size, bool solves_frozen)
      : solves_frozen_(solves_frozen), frozen_error_(size), not_coupled_(size), last_(size) {}

  double total() const { return frozen_error_ + coupling_error(); }
  bool coupling_is_larger() const { return coupling_error() > frozen_error_; }

  // A frozen sweep has changed delta by this much.  False if T does not contract, NaN included.
  bool swept(double change) {
    const double before = after_coupling_ ? last_ + frozen_error_ : last_;
    if (!(change < tuning.growth * before)) return false;
    // Between couplings the last ratio counts for more than those before it.
    const double remembered = after_coupling_ ? T_contraction_ : 0.9 * T_contraction_;
    T_contraction_ = std::min(std::max(remembered, change / before), 0.9);
    frozen_error_ = solves_frozen_ ? 0.0 : change * T_contraction_ / (1.0 - T_contraction_);
    not_coupled_ += change;
    last_ = change;
    after_coupling_ = false;
    return true;
  }

  // A coupling has changed delta by this much.
  void coupled(double change) {
    K_contraction_ = std::max(0.5 * K_contraction_, change / not_coupled_);
    frozen_error_ =
        solves_frozen_ ? change : frozen_error_ + change * T_contraction_ / (1.0 - T_contraction_);
    not_coupled_ = change;
    last_ = change;
    after_coupling_ = true;
  }

 private:
  double coupling_error() const { return K_contraction_ * not_coupled_; }

  bool solves_frozen_;
  double frozen_error_;  // error of delta as solution of delta = rhs + T delta
  double not_coupled_;   // norm of the part of delta to which K was not applied
  double last_;          // last change of delta
  bool after_coupling_ = false;
  double T_contraction_ = 0.0;
  double K_contraction_ = tuning.likely_contraction;
};

}  // namespace

AlternatingCorrection::AlternatingCorrection(const Unknowns& like)
    : rhs_(corrections_like(like)), coupled_(rhs_) {}

double AlternatingCorrection::couple(Corrections& delta, TwoPartJacobian& jacobian,
                                     const Corrections& R, const Corrections& rhs) {
  jacobian.couple(coupled_, delta);
  double change = 0.0;
  for (std::size_t kind = 0; kind < delta.size(); ++kind) {
    SingleStages& now = coupled_[kind];
    const SingleStages& before = rhs[kind];
    SingleStages& d = delta[kind];
    assign(now, [&](std::size_t i) { return R[kind][i] + now[i]; });
    change = larger(change, replace(d, [&](std::size_t i) { return d[i] + now[i] - before[i]; }));
  }
  std::swap(rhs_, coupled_);
  return change;
}

Correction AlternatingCorrection::solve(Corrections& delta, TwoPartJacobian& jacobian,
                                        const Unknowns& x, const Corrections& R,
                                        const CorrectionRequest& request,
                                        const IterationOptions& options) {
  copy(delta, R);
  jacobian.linearise(x, tuning.jacobian_share * request.forcing_term / request.size);
  const Corrections* rhs = &R;
  InnerErrors errors(request.size, jacobian.solves_frozen());
  for (int k = 0; k < tuning.inner_sweeps && !(errors.total() < request.forcing_term); ++k) {
    options.swept();
    if (k > 0 && errors.coupling_is_larger()) {
      errors.coupled(couple(delta, jacobian, R, *rhs));
      rhs = &rhs_;
    } else if (!errors.swept(jacobian.frozen_sweep(delta, *rhs))) {
      return {};
    }
  }
  return {.usable = errors.total() < request.size, .error = errors.total()};
}

void AlternatingCorrection::sweep_frozen(Corrections& delta, TwoPartJacobian& jacobian,
                                         const Unknowns& x, const Corrections& R,
                                         const IterationOptions& options) {
  copy(delta, R);
  jacobian.linearise(x, tuning.forcing_relative);
  for (int k = 0; k < tuning.frozen_sweeps; ++k) {
    options.swept();
    jacobian.frozen_sweep(delta, R);
  }
}

}  // namespace isosyrk
