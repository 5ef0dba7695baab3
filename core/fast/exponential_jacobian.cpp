#include "isosyrk/fast/exponential_jacobian.h"

#include <algorithm>

#include "isosyrk/solver/tuning.h"

namespace isosyrk {
namespace {

// ‖E δ‖ / ‖δ‖, where E is the derivative of a term of B̃, as a multiple of the term's part of B̃.  It
// is 0.8 to 2.5 at steps for errors of 1e-4 to 1e-6, 5 at the coarsest.
constexpr double likely_derivative = 2.5;
// E δ is left out of a correction if the error stays below this multiple of the forcing term.  The
// estimated error of x is then below the tolerance still.
constexpr double most_left_out = 1.4;
// Forcing term of δ_k, k > 0, as a part of that of the whole correction.
constexpr double forcing_of_next = 0.3;
// Part of what may be left out that may be cut from E δ.
constexpr double part_cut = 0.1;

}  // namespace

ExponentialJacobian::ExponentialJacobian(SplitOperations& operations, const ExponentialStep& step,
                                         GradedGradient& gradient, int order,
                                         const FastOptions& options)
    : lie_(operations.single_lie),
      step_(step),
      gradient_(gradient),
      order_(order),
      coupling_(operations, step, options.graded_series),
      neumann_({split_stages(1, operations.size())}),
      E_delta_({split_stages<float>(1, operations.size())}),
      next_delta_(E_delta_),
      B_of_sum_(operations.size()) {}

Correction ExponentialJacobian::correct(Corrections& delta, const SplitMatrix& Omega,
                                        const Corrections& R, const CorrectionRequest& request,
                                        const IterationOptions& options) {
  const double size = request.size;
  const double allowed = tuning.neumann_term * request.forcing_term;
  coupling_.linearize(Omega, allowed / size);  // K is needed to few digits
  double size_of_E = 0.0;                      // expected ‖E δ‖ / ‖δ‖
  if (order_ > 2) size_of_E = likely_derivative * gradient_.sizes().share_of_second();
  Correction correction = solve(delta, R, request, size_of_E, options);
  const double of_quadrature = coupling_.error_of_quadrature(size, norm(Omega));
  if (of_quadrature > allowed) correction.error += of_quadrature;
  if (order_ == 6) {
    correction.error +=
        likely_derivative * gradient_.sizes().share_of_derivative_of_fourth() * size;
  }
  return correction;
}

// Sets δ = Σ_k δ_k, where ‖E δ‖ / ‖δ‖ is expected to be size_of_E.
Correction ExponentialJacobian::solve(Corrections& delta, const Corrections& R,
                                      const CorrectionRequest& request, double size_of_E,
                                      const IterationOptions& options) {
  const double most_left = most_left_out * request.forcing_term;
  double size = request.size;          // of R, and then of E δ_{k-1}
  double left_out = size_of_E * size;  // ‖E δ_k‖, as expected
  // D is summed where E δ_k will have to be formed.
  coupling_.sum_D(left_out > most_left - request.forcing_term);
  Correction correction = neumann_.solve(delta, coupling_, R, request, options);  // δ₀
  while (correction.usable && coupling_.has_sum_of_D() && correction.error + left_out > most_left) {
    form_E_delta(part_cut * most_left / left_out);
    const double size_of_next = largest_norm(E_delta_[0]);
    if (!(size_of_next < size)) return {};  // NaN included
    left_out = size_of_next * size_of_next / size;
    size = size_of_next;
    coupling_.sum_D(left_out > most_left - request.forcing_term);
    const CorrectionRequest of_next = {.size = size,
                                       .forcing_term = forcing_of_next * request.forcing_term};
    const Correction next = neumann_.solve(next_delta_, coupling_, E_delta_, of_next, options);
    if (!next.usable) return {};
    delta[0][0] = delta[0][0] + next_delta_[0][0];
    correction.error += next.error;
  }
  correction.error += left_out;
  return correction;
}

// Sets E δ for the δ of the last sum of D.  Of its norm, `part` may be left out.
void ExponentialJacobian::form_E_delta(double part) {
  SingleMatrix& D = coupling_.sum_of_D();
  SingleMatrix& E_delta = E_delta_[0][0];
  lie_.neglect(part);
  lie_.cut(D);
  lie_.generate(B_of_sum_, D);
  gradient_.derivative_of_second(E_delta, D, B_of_sum_, step_.h);
  E_delta = step_.h * E_delta;
}

}  // namespace isosyrk
