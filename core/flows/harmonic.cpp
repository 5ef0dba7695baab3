#include "isosyrk/flows/harmonic.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace isosyrk {

RealVector harmonic(Index n, int l, int m) {
  if (m < 0 || m > l || l >= n) {
    throw std::invalid_argument(
        fmt::format("harmonic: l = {}, m = {}, n = {}; must be 0 <= m <= l < n", l, m, n));
  }
  // The eigenvalue is known, so the eigenvector v follows from its first entry by the three-term
  // recurrence  e_i v_{i+1} = (l(l+1) - d_i) v_i - e_{i-1} v_{i-1}.  It is stable up to the middle,
  // where v grows, then oscillates.  The other half is the mirror image, of parity (-1)^(l-m).
  // Extended precision with integers under the roots gives an error of a few roundings at any n; an
  // eigensolver in double loses a factor n².  The sign of the first entry is right even if that
  // entry is far below rounding.
  using Extended = long double;
  const Index length = n - m;
  const auto off_diagonal = [n, m](Index i) {  // as Laplacian::off_diagonal, from integers
    const Index under_root = (i + 1) * (n - 1 - i) * (i + m + 1) * (n - 1 - i - m);
    return -std::sqrt(static_cast<Extended>(under_root));
  };
  const auto diagonal = [n, m](Index i) {
    const Index doubled = n * n - 1 - (n - 1 - 2 * i) * (n - 1 - 2 * (i + m));
    return static_cast<Extended>(doubled) / 2;
  };
  const Extended eigenvalue = static_cast<Extended>(l) * static_cast<Extended>(l + 1);
  const Extended parity = (l - m) % 2 == 0 ? 1 : -1;

  std::vector<Extended> v(static_cast<std::size_t>(length), 0);
  v[0] = m % 2 == 0 ? 1 : -1;
  const Index middle = (length - 1) / 2;
  for (Index i = 0; i < middle; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Extended before = i == 0 ? 0 : off_diagonal(i - 1) * v[at - 1];
    v[at + 1] = ((eigenvalue - diagonal(i)) * v[at] - before) / off_diagonal(i);
  }
  if (length % 2 == 1 && parity < 0) v[static_cast<std::size_t>(middle)] = 0;
  Extended square = 0;
  for (Index i = 0; i < length; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (i > middle) v[at] = parity * v[static_cast<std::size_t>(length - 1 - i)];
    square += v[at] * v[at];
  }
  const Extended norm = std::sqrt(square);
  RealVector T(length);
  for (Index i = 0; i < length; ++i) {
    T(i) = static_cast<double>(v[static_cast<std::size_t>(i)] / norm);
  }
  return T;
}

}  // namespace isosyrk
