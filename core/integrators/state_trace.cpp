#include "isosyrk/integrators/state_trace.h"

#include <cmath>
#include <limits>

#include "isosyrk/integrators/state_scale.h"

namespace isosyrk {

double trace_part(const ConstMatrixView& W) {
  const auto n = static_cast<double>(W.rows());
  const double rounding = n * std::numeric_limits<double>::epsilon();
  // Rounded once: a sum in double precision would leave more than a unit in the last place of c.
  long double sum = 0.0;
  double largest = 0.0;
  for (Index i = 0; i < W.rows(); ++i) {
    sum += W(i, i).imag();
    largest = larger(largest, std::abs(W(i, i).imag()));
  }
  const auto c = static_cast<double>(sum / static_cast<long double>(n));
  // The first bound saves a pass over W.
  if (!(std::abs(c) > rounding * largest) || !std::isfinite(c)) return 0.0;
  return std::abs(c) > rounding * frobenius_norm(W) ? c : 0.0;
}

}  // namespace isosyrk
