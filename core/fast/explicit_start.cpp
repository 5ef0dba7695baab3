#include "isosyrk/fast/explicit_start.h"

#include "isosyrk/solver/tuning.h"

namespace isosyrk {
namespace {

// Largest part of Ω that may be the rounding of a rotation left out of B.  In single precision that
// rounding is about n u ‖hR‖_F.
constexpr double largest_rounding = 0.1;

}  // namespace

ExplicitStart::ExplicitStart(SplitOperations& operations, const ExponentialStep& step,
                             ExponentialUpdate& update, int order)
    : lie_(operations.single_lie),
      step_(step),
      update_(update),
      magnus_(operations.single_lie, order == 6 ? magnus5() : magnus4()),
      Omega_(operations.size()) {}

bool ExplicitStart::form(SplitMatrix& Omega) {
  lie_.neglect(tuning.single_roundoff);
  magnus_.form_exponent(Omega_, step_.W0_single, step_.h);
  widen(Omega, Omega_);
  const double rounding =
      tuning.single_roundoff * static_cast<double>(Omega.size()) * step_.rotation;
  if (rounding > largest_rounding * norm(Omega)) return false;
  step_.memory->start_error.add_expected(
      Omega, [&](SingleMatrix& out, const SingleMatrix& X) { update_.transport(out, X); });
  return true;
}

}  // namespace isosyrk
