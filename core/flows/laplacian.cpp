#include "isosyrk/flows/laplacian.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <stdexcept>

#include "isosyrk/flows/spin.h"

namespace isosyrk {
namespace {

// P(r, c) = -conj(P(c, r)) for r > c, four rows at a time: the four entries read together share a
// cache line.
void mirror_skew_hermitian(Matrix& P) {
  const Index n = P.rows();
  constexpr Index rows = 4;
  for (Index first = 0; first < n; first += rows) {
    const Index end = std::min(first + rows, n);
    for (Index c = 0; c < first; ++c) {
      for (Index r = first; r < end; ++r) P(r, c) = -std::conj(P(c, r));
    }
    for (Index r = first; r < end; ++r) {
      for (Index c = first; c < r; ++c) P(r, c) = -std::conj(P(c, r));
    }
  }
}

}  // namespace

RealVector Laplacian::diagonal(Index n, Index m) {
  const Spin spin(n);
  RealVector d(n - m);
  for (Index i = 0; i < n - m; ++i) {
    d(i) = 2.0 * (spin.j * (spin.j + 1.0) - spin.magnetic(i) * spin.magnetic(i + m));
  }
  return d;
}

RealVector Laplacian::off_diagonal(Index n, Index m) {
  const Spin spin(n);
  RealVector e(n - m - 1);
  for (Index i = 0; i + 1 < n - m; ++i) e(i) = -spin.ladder(i) * spin.ladder(i + m);
  return e;
}

Laplacian::Laplacian(Index n) : n_(n) {
  if (n < 2) throw std::invalid_argument(fmt::format("laplacian: n = {}, must be at least 2", n));
  row_start_.resize(static_cast<std::size_t>(n));
  Index total = 0;
  for (Index i = 0; i < n; ++i) {
    row_start_[static_cast<std::size_t>(i)] = total;
    total += 2 * (n - i);
  }
  lower_.assign(static_cast<std::size_t>(total), 0.0);
  reciprocal_pivot_.assign(static_cast<std::size_t>(total), 0.0);

  for (Index m = 0; m < n; ++m) {
    RealVector d = diagonal(n, m);
    RealVector e = off_diagonal(n, m);
    // Diagonal m = 0 is singular (l = 0), but its leading n-1 rows are positive definite.  The last
    // unknown is pinned to 0 (reciprocal pivot 0), and the solve subtracts the mean at the end.
    const Index rank = m == 0 ? n - 1 : n - m;
    const double coupling = m == 0 ? e(n - 2) : 0.0;
    const lapack_int info = LAPACKE_dpttrf(static_cast<lapack_int>(rank), d.data(), e.data());
    if (info != 0) {
      throw std::runtime_error(
          fmt::format("laplacian: factoring diagonal {} failed ({})", m, info));
    }
    if (m == 0) e(n - 2) = coupling / d(n - 2);
    for (Index i = 0; i < n - m; ++i) {
      const auto at = static_cast<std::size_t>(row_start_[static_cast<std::size_t>(i)] + 2 * m);
      const double l = i == 0 ? 0.0 : e(i - 1);
      const double pivot = i < rank ? 1.0 / d(i) : 0.0;
      lower_[at] = lower_[at + 1] = l;
      reciprocal_pivot_[at] = reciprocal_pivot_[at + 1] = pivot;
    }
    if (m == 0) {
      // Solution for a right-hand side of ones with last unknown 0, as in solve_skew_hermitian.
      RealVector ones = RealVector::Constant(n - 1, -1.0);
      LAPACKE_dpttrs(LAPACK_COL_MAJOR, static_cast<lapack_int>(n - 1), 1, d.data(), e.data(),
                     ones.data(), static_cast<lapack_int>(n - 1));
      identity_solution_ = RealVector::Zero(n);
      identity_solution_.head(n - 1) = ones;
    }
  }
}

void Laplacian::apply(const Matrix& W, Matrix& out) const {
  const Spin spin(n_);
  for (Index i = 0; i < n_; ++i) {
    for (Index k = 0; k < n_; ++k) {
      Complex sum =
          -2.0 * (spin.j * (spin.j + 1.0) - spin.magnetic(i) * spin.magnetic(k)) * W(i, k);
      if (i > 0 && k > 0) sum += spin.ladder(i - 1) * spin.ladder(k - 1) * W(i - 1, k - 1);
      if (i + 1 < n_ && k + 1 < n_) sum += spin.ladder(i) * spin.ladder(k) * W(i + 1, k + 1);
      out(i, k) = sum;
    }
  }
}

void Laplacian::solve_skew_hermitian(const Matrix& W, double scale, Matrix& P) const {
  // Returns row i from the diagonal on, as real numbers.
  const auto row_of = [this](auto* entries, Index i) { return entries + 2 * (i * n_ + i); };
  const auto coefficients_of = [this](const std::vector<double>& packed, Index i) {
    return packed.data() + row_start_[static_cast<std::size_t>(i)];
  };
  const auto* w = reinterpret_cast<const double*>(W.data());
  auto* p = reinterpret_cast<double*>(P.data());

  // Forward elimination, all diagonals at once: y_i = f_i - l_i y_{i-1}.
  std::copy(w, w + 2 * n_, p);
  for (Index i = 1; i < n_; ++i) {
    const double* __restrict f = row_of(w, i);
    const double* __restrict l = coefficients_of(lower_, i);
    const double* __restrict above = row_of(p, i - 1);
    double* __restrict y = row_of(p, i);
    for (Index k = 0; k < 2 * (n_ - i); ++k) y[k] = f[k] - l[k] * above[k];
  }

  // Back substitution: x_i = y_i / d_i - l_{i+1} x_{i+1}, with Δ = -(L D L^T).
  for (Index i = n_ - 1; i >= 0; --i) {
    const double* __restrict d = coefficients_of(reciprocal_pivot_, i);
    double* __restrict x = row_of(p, i);
    const Index last = 2 * (n_ - 1 - i);  // this diagonal ends here: nothing below
    if (last > 0) {
      const double* __restrict l = coefficients_of(lower_, i + 1);
      const double* __restrict below = row_of(p, i + 1);
      for (Index k = 0; k < last; ++k) x[k] = -scale * d[k] * x[k] - l[k] * below[k];
    }
    x[last] *= -scale * d[last];
    x[last + 1] *= -scale * d[last + 1];
  }

  // Main diagonal: subtract the contribution of the trace of W, then the trace of P.
  double mean_of_W = 0.0;
  double mean = 0.0;
  for (Index i = 0; i < n_; ++i) mean_of_W += W(i, i).imag();
  mean_of_W *= scale / static_cast<double>(n_);
  for (Index i = 0; i < n_; ++i) {
    P(i, i) = Complex(0.0, P(i, i).imag() - mean_of_W * identity_solution_(i));
    mean += P(i, i).imag();
  }
  mean /= static_cast<double>(n_);
  for (Index i = 0; i < n_; ++i) P(i, i) -= Complex(0.0, mean);
  mirror_skew_hermitian(P);
}

}  // namespace isosyrk
