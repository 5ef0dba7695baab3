#include "isosyrk/flows/spherical_harmonics.h"

#include <cmath>
#include <limits>
#include <vector>

namespace isosyrk {

// P_lm grows from P_mm ~ cos^m β, so a start that underflows loses it.  P_lm matters where
// m <= l cos β, and there cos^m β >= (m/n)^m >= exp(-n/e): 1e-82 at n = 513, 1e-655 at n = 4096,
// which is no double.  In extended precision, down to 1e-4932, a start that underflows belongs to a
// P_lm that stays far below rounding for all l < n.
using Extended = long double;

Matrix along_latitudes(const Matrix& coefficients, const RealVector& latitudes) {
  const Index n = coefficients.rows();
  const auto rows = static_cast<std::size_t>(latitudes.size());
  std::vector<Extended> start(rows, 1), sine(rows), cosine(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const Extended latitude = latitudes(static_cast<Index>(row));
    sine[row] = std::sin(latitude);
    cosine[row] = std::cos(latitude);
  }
  Matrix sums = Matrix::Zero(latitudes.size(), n);
  std::vector<Extended> alpha(static_cast<std::size_t>(n));
  std::vector<Complex> c(static_cast<std::size_t>(n));
  for (Index m = 0; m < n; ++m) {
    const auto first = static_cast<std::size_t>(m), end = static_cast<std::size_t>(n);
    for (std::size_t l = first; l < end; ++l) {
      c[l] = coefficients(static_cast<Index>(l), m);
      const auto numerator = static_cast<Extended>(4 * l * l - 1);
      if (l > first) alpha[l] = std::sqrt(numerator / static_cast<Extended>(l * l - first * first));
    }
    const Extended ratio =
        m == 0 ? 1 : std::sqrt(static_cast<Extended>(2 * m + 1) / static_cast<Extended>(2 * m));
    for (std::size_t row = 0; row < rows; ++row) {
      if (m > 0) start[row] *= ratio * cosine[row];
      if (start[row] < std::numeric_limits<Extended>::min()) continue;
      Extended before = 0, P = start[row];
      Extended real = c[first].real() * P, imaginary = c[first].imag() * P;
      for (std::size_t l = first + 1; l < end; ++l) {
        const Extended next = alpha[l] * (sine[row] * P - before);
        before = P / alpha[l];
        P = next;
        real += c[l].real() * P;
        imaginary += c[l].imag() * P;
      }
      sums(static_cast<Index>(row), m) =
          Complex(static_cast<double>(real), static_cast<double>(imaginary));
    }
  }
  return sums;
}

}  // namespace isosyrk
