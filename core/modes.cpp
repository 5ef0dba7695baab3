#include "core/modes.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <set>
#include <stdexcept>
#include <utility>

#include "core/invariants.h"
#include "core/laplacian.h"

namespace isosyrk {

const std::vector<Mode>& default_modes() {
  static const std::vector<Mode> modes = {
      {1, 0, {1.0, 0.0}},   {1, 1, {-0.3, 1.3}},  {2, 0, {-0.7, 0.0}}, {2, 1, {-1.4, 0.1}},
      {2, 2, {-1.0, -0.6}}, {3, 0, {0.2, 0.0}},   {3, 1, {-1.0, -0.6}}, {3, 2, {0.6, -2.0}},
      {3, 3, {0.8, 1.4}},   {4, 0, {-0.6, 0.0}},  {4, 1, {1.2, 2.4}},  {4, 2, {1.8, -0.7}},
      {4, 3, {0.3, 1.3}},   {4, 4, {0.9, -0.3}},
  };
  return modes;
}

void require_valid(const std::vector<Mode>& modes, Index n) {
  std::set<std::pair<int, int>> seen;
  bool all_zero = true;
  for (const Mode& mode : modes) {
    const auto fail = [&mode](const std::string& why) {
      throw std::invalid_argument(fmt::format("mode l={}, m={}: {}", mode.l, mode.m, why));
    };
    if (mode.l < 1 || mode.l >= n) fail(fmt::format("l must be 1 to n-1 = {}", n - 1));
    if (mode.m < 0 || mode.m > mode.l) fail("m must be 0 to l");
    if (!std::isfinite(mode.value.real()) || !std::isfinite(mode.value.imag())) {
      fail(fmt::format("value {} + {}i must be finite", mode.value.real(), mode.value.imag()));
    }
    if (mode.m == 0 && mode.value.imag() != 0.0) {
      fail(fmt::format("im = {} must be 0 where m = 0", mode.value.imag()));
    }
    if (!seen.emplace(mode.l, mode.m).second) fail("given twice, allowed once");
    if (mode.value != 0.0) all_zero = false;
  }
  if (all_zero) throw std::invalid_argument("modes: at least one must be nonzero");
}

namespace {

// Sign of v_k relative to v_0 for the eigenvector v of the tridiagonal (d, e) for the eigenvalue
// lambda, by its three-term recurrence from v_0 = 1.  Towards growing |v| this is stable, and it
// settles the sign even where v_0 itself is far below rounding.
double sign_by_recurrence(const RealVector& d, const RealVector& e, double lambda, Index k) {
  double previous = 0.0;
  double current = 1.0;
  for (Index i = 0; i < k; ++i) {
    const double coupling = i == 0 ? 0.0 : e(i - 1) * previous;
    const double next = ((lambda - d(i)) * current - coupling) / e(i);
    previous = current;
    current = next;
    const double size = std::max(std::abs(current), std::abs(previous));
    current /= size;
    previous /= size;
  }
  return current < 0.0 ? -1.0 : 1.0;
}

}  // namespace

RealVector harmonic(Index n, int l, int m) {
  if (m < 0 || m > l || l >= n) {
    throw std::invalid_argument(
        fmt::format("harmonic: l = {}, m = {}, n = {}; must be 0 <= m <= l < n", l, m, n));
  }
  const Index length = n - m;
  const double first_sign = m % 2 == 0 ? 1.0 : -1.0;
  if (length == 1) return RealVector::Constant(1, first_sign);

  const RealVector d = Laplacian::diagonal(n, m);
  const RealVector e = Laplacian::off_diagonal(n, m);
  // The eigenvalues of diagonal m are l(l+1), l = m..n-1, ascending: number l-m+1 is wanted.
  RealVector d_work = d;
  RealVector e_work(length);  // LAPACK wants one entry more than it reads
  e_work << e, 0.0;
  RealVector eigenvalues(length);
  RealVector v(length);
  lapack_int found = 0;
  lapack_int support[2];
  const auto wanted = static_cast<lapack_int>(l - m + 1);
  const lapack_int info = LAPACKE_dstevr(
      LAPACK_COL_MAJOR, 'V', 'I', static_cast<lapack_int>(length), d_work.data(), e_work.data(),
      0.0, 0.0, wanted, wanted, 0.0, &found, eigenvalues.data(), v.data(),
      static_cast<lapack_int>(length), support);
  if (info != 0 || found != 1) {
    throw std::runtime_error(fmt::format("harmonic: no eigenvector for l = {}, m = {}", l, m));
  }
  v.normalize();
  // Compare signs at the first entry that is clearly above rounding.
  const double largest = v.cwiseAbs().maxCoeff();
  Index k = 0;
  while (std::abs(v(k)) < 0.1 * largest) ++k;
  const double lambda = static_cast<double>(l) * (static_cast<double>(l) + 1.0);
  const double sign = (v(k) < 0.0 ? -1.0 : 1.0) * sign_by_recurrence(d, e, lambda, k);
  return first_sign * sign * v;
}

Matrix vorticity_from_modes(const std::vector<Mode>& modes, Index n) {
  require_valid(modes, n);
  const Complex imaginary_unit(0.0, 1.0);
  Matrix W = Matrix::Zero(n, n);
  for (const Mode& mode : modes) {
    const RealVector T = harmonic(n, mode.l, mode.m);
    for (Index i = 0; i < T.size(); ++i) W(i, i + mode.m) += imaginary_unit * mode.value * T(i);
  }
  for (Index i = 0; i < n; ++i) {
    for (Index k = i + 1; k < n; ++k) W(k, i) = -std::conj(W(i, k));
  }
  W /= spectral_norm(W);
  return W;
}

}  // namespace isosyrk
