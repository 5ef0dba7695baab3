// Powers of two as units: multiplying by one changes no digit.
#pragma once

#include <algorithm>
#include <cmath>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns the e with 2^e at most the largest |re| and |im| of the entries of W, and 2^(e+1) above
/// it; 0 if W is 0 or not finite.  e is cut to ±1022, so that 2^e and 2^-e are normal doubles.
template <class Scalar>
int exponent_of_largest(const MatrixOf<Scalar>& W) {
  constexpr int most = 1022;
  const double largest = std::max(W.real().cwiseAbs().maxCoeff(), W.imag().cwiseAbs().maxCoeff());
  if (largest == 0.0 || !std::isfinite(largest)) return 0;
  return std::clamp(std::ilogb(largest), -most, most);
}

/// Returns 2^exponent W, with |exponent| at most 1022.
template <class Scalar>
MatrixOf<Scalar> times_power_of_two(const MatrixOf<Scalar>& W, int exponent) {
  return std::ldexp(1.0, exponent) * W;
}

}  // namespace isosyrk
