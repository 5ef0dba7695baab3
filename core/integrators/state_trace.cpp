#include "isosyrk/integrators/state_trace.h"

#include <cmath>
#include <limits>

#include "isosyrk/integrators/state_scale.h"

namespace isosyrk {

double trace_part(const ConstMatrixView& W) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  // A sum in double precision would err by as much as what stays where it is.
  long double sum = 0.0;
  double largest = 0.0;
  for (Index i = 0; i < W.rows(); ++i) {
    sum += W(i, i).imag();
    largest = larger(largest, std::abs(W(i, i).imag()));
  }
  const auto c = static_cast<double>(sum / static_cast<long double>(W.rows()));
  // The first bound saves a pass over W.
  if (!(std::abs(c) > epsilon * largest) || !std::isfinite(c)) return 0.0;
  return std::abs(c) > epsilon * frobenius_norm(W) ? c : 0.0;
}

}  // namespace isosyrk
