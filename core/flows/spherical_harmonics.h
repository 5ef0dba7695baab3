// Fields on the sphere from their coefficients in spherical harmonics.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Returns a_m(β) = Σ_{l>=m} c_lm P_lm(sin β) for each latitude β, a row each, and m = 0..n-1,
/// given c_lm at (l, m), 0 <= m <= l, of an n x n matrix.  The real field of these coefficients has
/// at longitude λ the value  a_0 + 2 Re Σ_{m>0} a_m exp(imλ).
///
/// P_lm is the associated Legendre function without the phase of Condon and Shortley, positive next
/// to the north pole, normalised so that P_lm(sin β) exp(imλ) has mean square 1 over the sphere:
///
///     P_mm = sqrt((2m+1)/(2m)) cos β P_{m-1,m-1},  P_00 = 1
///     P_lm = α_lm (sin β P_{l-1,m} - P_{l-2,m} / α_{l-1,m}),  α_lm = sqrt((4l² - 1)/(l² - m²))
///
/// Takes O(n²) operations and O(n) memory a latitude.
Matrix along_latitudes(const Matrix& coefficients, const RealVector& latitudes);

}  // namespace isosyrk
