#include "isosyrk/fast/exponential_update.h"

#include <limits>

namespace isosyrk {
namespace {

// Error that U may have, as a part of the tolerance.
constexpr double part_of_tolerance = 0.1;

}  // namespace

void ExponentialUpdate::form(SplitMatrix& W1, const SplitMatrix& Omega) {
  Omega_ = 1.0 * Omega;
  const double error = part_of_tolerance * step_.tolerance * step_.unit(Omega);
  operations_.bands.truncate(Omega_, error);
  const bool is_formed = exponential_.conjugate(W1, step_.memory->adjoint, Omega_, *step_.W0, error,
                                                operations_.products, operations_.single_products);
  if (!is_formed) W1.re()[0] = std::numeric_limits<double>::quiet_NaN();  // the step diverges
}

void ExponentialUpdate::transport(SingleMatrix& out, const SingleMatrix& X) {
  exponential_.transport(out, step_.memory->adjoint, X, operations_.single_products);
}

}  // namespace isosyrk
