// The size of Ω to which the tolerance of exponential methods is relative.
#pragma once

#include <algorithm>
#include <limits>

namespace isosyrk {

/// Rounding of B(W), relative to ‖B(W)‖_F.  Where W changes by its rounding, B(W) was seen to
/// change by 1 to 7 units of rounding (Euler-Zeitlin, n = 5 to 257).
inline constexpr double rounding_of_generator = 8.0 * std::numeric_limits<double>::epsilon();

/// Returns the least unit of Ω, for a `rotation` of ‖hR‖_F.
///
/// In the co-rotating frame Ω = h (B(W) - R), with a rotation R that may be all of B(W).  Ω then
/// errs by the rounding of hR: an error of it below rounding_of_generator ‖hR‖_F cannot be seen.
/// Nor need it be, since W₁ changes by 2 ‖δΩ‖ ‖W‖ at most: for ‖hR‖ of order 1 this is the rounding
/// of W₁.  So this error is what the tolerance allows at least.  0 without a frame.
inline double least_unit_of_exponent(double rotation, double tolerance) {
  return rounding_of_generator * rotation / tolerance;
}

/// Returns the unit of an Ω with ‖Ω‖_F = size.  It is 1 where both are 0: without B or h nothing
/// moves.
inline double unit_of_exponent(double size, double least) {
  const double unit = std::max(size, least);
  return unit > 0.0 ? unit : 1.0;
}

}  // namespace isosyrk
