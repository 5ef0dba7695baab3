#include "isosyrk/flows/harmonic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace isosyrk {

// Extended precision with integers under the roots gives an error of a few roundings at any n; an
// eigensolver in double loses a factor n².
using Extended = long double;

Harmonics::Harmonics(Index n, Index m) : n_(n), m_(m) {
  if (m < 0 || m >= n) {
    throw std::invalid_argument(fmt::format("harmonics: m = {}, n = {}; must be 0 <= m < n", m, n));
  }
  for (Index i = 0; i + 1 < n - m; ++i) {  // as Laplacian::off_diagonal, from integers
    const Index under_root = (i + 1) * (n - 1 - i) * (i + m + 1) * (n - 1 - i - m);
    off_diagonal_.push_back(-std::sqrt(static_cast<Extended>(under_root)));
  }
  v_.resize(static_cast<std::size_t>((n - m + 1) / 2));
  T_.resize(n - m);
}

const RealVector& Harmonics::operator()(Index l) {
  if (l < m_ || l >= n_) {
    throw std::invalid_argument(
        fmt::format("harmonic: l = {}, m = {}, n = {}; must be 0 <= m <= l < n", l, m_, n_));
  }
  // The eigenvalue is known, so the eigenvector v follows from its first entry by the three-term
  // recurrence  e_i v_{i+1} = (l(l+1) - d_i) v_i - e_{i-1} v_{i-1}.  It is stable up to the middle,
  // where v grows, then oscillates.  The other half is the mirror image, of parity (-1)^(l-m).
  // The sign of the first entry is right even if that entry is far below rounding.
  const Index length = n_ - m_;
  const auto diagonal = [this](Index i) {
    const Index doubled = n_ * n_ - 1 - (n_ - 1 - 2 * i) * (n_ - 1 - 2 * (i + m_));
    return static_cast<Extended>(doubled) / 2;
  };
  const Extended eigenvalue = static_cast<Extended>(l) * static_cast<Extended>(l + 1);
  const double parity = (l - m_) % 2 == 0 ? 1.0 : -1.0;

  v_[0] = m_ % 2 == 0 ? 1 : -1;
  const Index middle = (length - 1) / 2;
  for (Index i = 0; i < middle; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Extended before = i == 0 ? 0 : off_diagonal_[at - 1] * v_[at - 1];
    v_[at + 1] = ((eigenvalue - diagonal(i)) * v_[at] - before) / off_diagonal_[at];
  }
  if (length % 2 == 1 && parity < 0) v_[static_cast<std::size_t>(middle)] = 0;
  const auto half = [&](Index i) { return v_[static_cast<std::size_t>(i)]; };
  Extended square = 0;
  for (Index i = 0; i < length; ++i) {
    const Extended entry = half(std::min(i, length - 1 - i));
    square += entry * entry;
  }
  const Extended norm = std::sqrt(square);
  for (Index i = 0; i <= middle; ++i) {
    T_(i) = static_cast<double>(half(i) / norm);
    if (i < length - 1 - i) T_(length - 1 - i) = parity * T_(i);
  }
  return T_;
}

RealVector harmonic(Index n, int l, int m) {
  if (m < 0 || m > l || l >= n) {
    throw std::invalid_argument(
        fmt::format("harmonic: l = {}, m = {}, n = {}; must be 0 <= m <= l < n", l, m, n));
  }
  return Harmonics(n, m)(l);
}

Matrix harmonic_coefficients(const Matrix& W) {
  const Index n = W.rows();
  const Complex minus_i(0.0, -1.0);
  Matrix coefficients = Matrix::Zero(n, n);
  for (Index m = 0; m < n; ++m) {
    Harmonics harmonics(n, m);
    const Eigen::VectorXcd diagonal = minus_i * W.diagonal(m);
    for (Index l = m; l < n; ++l) {
      const RealVector& T = harmonics(l);
      const double imaginary = m == 0 ? 0.0 : T.dot(diagonal.imag());
      coefficients(l, m) = Complex(T.dot(diagonal.real()), imaginary);
    }
  }
  return coefficients;
}

}  // namespace isosyrk
