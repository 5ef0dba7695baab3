// Entries of the spin-j representation of so(3) in n = 2j + 1 dimensions.
#pragma once

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Spin j = (n-1)/2 with magnetic numbers m_i = j - i, i = 0..n-1.  S_z = diag(m_i), and S_x ± i
/// S_y are the ladder matrices.
struct Spin {
  explicit Spin(Index size) : n(size), j((static_cast<double>(size) - 1.0) / 2.0) {}

  Index n;
  double j;

  /// Returns m_i.
  double magnetic(Index i) const { return j - static_cast<double>(i); }
  /// Returns (S_x + i S_y)_{i, i+1} = sqrt(j(j+1) - m_i (m_i - 1)).  The number under the root is
  /// the integer (i+1)(n-1-i).
  double ladder(Index i) const {
    return std::sqrt(static_cast<double>(i + 1) * static_cast<double>(n - 1 - i));
  }
  /// Returns tr S_a² = n(n² - 1)/12, the same for a = x, y, z.
  double squared_norm() const {
    const auto size = static_cast<double>(n);
    return size * (size * size - 1.0) / 12.0;
  }
};

}  // namespace isosyrk
