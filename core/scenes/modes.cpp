#include "isosyrk/scenes/modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "isosyrk/flows/harmonic.h"
#include "isosyrk/linalg/byte_hash.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/scenes/normal_numbers.h"

namespace isosyrk {

const std::vector<Mode>& default_modes() {
  static const std::vector<Mode> modes = {
      {1, 0, {1.0, 0.0}},   {1, 1, {-0.3, 1.3}}, {2, 0, {-0.7, 0.0}},  {2, 1, {-1.4, 0.1}},
      {2, 2, {-1.0, -0.6}}, {3, 0, {0.2, 0.0}},  {3, 1, {-1.0, -0.6}}, {3, 2, {0.6, -2.0}},
      {3, 3, {0.8, 1.4}},   {4, 0, {-0.6, 0.0}}, {4, 1, {1.2, 2.4}},   {4, 2, {1.8, -0.7}},
      {4, 3, {0.3, 1.3}},   {4, 4, {0.9, -0.3}},
  };
  return modes;
}

std::vector<Mode> rough_modes(Index n) {
  if (n < 2) throw std::invalid_argument(fmt::format("rough_modes: n = {}, must be at least 2", n));
  NormalNumbers normal;
  std::vector<Mode> modes;
  for (int l = 1; l < n; ++l) {
    const double size = std::sqrt((l + 1.0) / (1.0 * l * l * (2.0 * l + 1.0)));
    modes.push_back({l, 0, {size * normal.next(), 0.0}});
    for (int m = 1; m <= l; ++m) {
      const double real = normal.next();
      const double imaginary = normal.next();
      modes.push_back({l, m, Complex(real, imaginary) * (size / std::numbers::sqrt2)});
    }
  }
  return modes;
}

namespace {

[[noreturn]] void fail(const Mode& mode, const std::string& why) {
  throw std::invalid_argument(fmt::format("mode l={}, m={}: {}", mode.l, mode.m, why));
}

}  // namespace

void require_valid_mode(const Mode& mode, Index n) {
  if (mode.l < 1 || mode.l >= n) fail(mode, fmt::format("l must be 1 to n-1 = {}", n - 1));
  if (mode.m < 0 || mode.m > mode.l) fail(mode, "m must be 0 to l");
  const double re = mode.value.real();
  const double im = mode.value.imag();
  if (!std::isfinite(re) || !std::isfinite(im)) {
    fail(mode, fmt::format("value {} + {}i must be finite", re, im));
  }
  if (mode.m == 0 && im != 0.0) fail(mode, fmt::format("im = {} must be 0 where m = 0", im));
}

void require_valid(const std::vector<Mode>& modes, Index n) {
  std::set<std::pair<int, int>> seen;
  bool all_zero = true;
  for (const Mode& mode : modes) {
    require_valid_mode(mode, n);
    if (!seen.emplace(mode.l, mode.m).second) fail(mode, "given twice, allowed once");
    if (mode.value != 0.0) all_zero = false;
  }
  if (all_zero) throw std::invalid_argument("modes: at least one must be nonzero");
}

Matrix vorticity_from_modes(const std::vector<Mode>& modes, Index n) {
  require_valid(modes, n);
  // A power of two is divided out first, so that squares of very large or very small values neither
  // overflow nor underflow.  W is scaled to norm 1 at the end.
  double largest = 0.0;
  for (const Mode& mode : modes) {
    largest = std::max({largest, std::abs(mode.value.real()), std::abs(mode.value.imag())});
  }
  const int exponent = std::ilogb(largest);
  const auto scaled = [exponent](Complex value) {
    return Complex(std::scalbn(value.real(), -exponent), std::scalbn(value.imag(), -exponent));
  };
  const Complex imaginary_unit(0.0, 1.0);
  Matrix W = Matrix::Zero(n, n);
  for (const Mode& mode : modes) {
    const RealVector T = harmonic(n, mode.l, mode.m);
    for (Index i = 0; i < T.size(); ++i)
      W(i, i + mode.m) += imaginary_unit * scaled(mode.value) * T(i);
  }
  for (Index i = 0; i < n; ++i) {
    for (Index k = i + 1; k < n; ++k) W(k, i) = -std::conj(W(i, k));
  }
  W /= spectral_norm(W);
  return W;
}

std::string hash_of(const std::vector<Mode>& modes) {
  std::uint64_t hash = hash_of_nothing;
  for (const Mode& mode : modes) {
    const std::string line =
        fmt::format("{},{},{},{}\n", mode.l, mode.m, mode.value.real(), mode.value.imag());
    hash = hash_after(hash, line.data(), line.size());
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace isosyrk
