#include "isosyrk/split/bands.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/split/linear_combination.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {
namespace {

// Returns |W(row, c)|² for the columns c = first ... first + count - 1.
template <class Real>
auto squares_in_row(const SplitMatrixOf<Real>& W, Index row, Index first, Index count) {
  const auto of = [&](const Real* part) {
    using Row = Eigen::Array<Real, Eigen::Dynamic, 1>;
    return Eigen::Map<const Row>(part + row * W.stride() + first, count)
        .template cast<double>()
        .square();
  };
  return of(W.re()) + of(W.im());
}

// squares(m) = Σ |W(r, c)|² over |r - c| = m, for a share of the diagonals m = 0 ... n - 1.  Of a
// Hermitian or skew-Hermitian matrix only the upper triangle is read, and counts twice, but for the
// diagonal.
template <class Real>
void sum_over_diagonals(RealVector& squares, const SplitMatrixOf<Real>& W, bool is_symmetric,
                        Share share) {
  const Index n = W.size();
  const Index first = n * share.first / share.parts;
  const Index last = n * share.end / share.parts;
  squares.segment(first, last - first).setZero();
  const Index end = std::min(last, W.band() + 1);
  const Index nearest = std::max<Index>(first, 1);
  for (Index i = 0; i < n; ++i) {
    const Index above = std::min(end, n - i);
    if (first < above) {
      squares.segment(first, above - first).array() +=
          squares_in_row(W, i, i + first, above - first);
    }
    const Index below = std::min(end, i + 1);
    if (!is_symmetric && nearest < below) {
      squares.segment(nearest, below - nearest).array() +=
          squares_in_row(W, i, i - below + 1, below - nearest).reverse();
    }
  }
  if (is_symmetric && nearest < end) squares.segment(nearest, end - nearest) *= 2.0;
}

// Sets the entries with inner < |r - c| <= outer to 0, in the rows of the share.
template <class Real>
void clear_between(SplitMatrixOf<Real>& W, Index inner, Index outer, Share share) {
  if (outer <= inner) return;
  const Index n = W.size();
  const parallel::Rows rows = parallel::rows_of_share(n, share);
  for (Index i = rows.begin; i < rows.end; ++i) {
    const Index left = std::max<Index>(0, i - outer);
    const Index right = std::min(n, i + outer + 1);
    for (Real* part : {W.re(), W.im()}) {
      Real* row = part + i * W.stride();
      if (left < i - inner) std::fill(row + left, row + i - inner, Real{0});
      if (i + inner + 1 < right) std::fill(row + i + inner + 1, row + right, Real{0});
    }
  }
}

// Returns the smallest band outside which a matrix has Frobenius norm at most `tail`.  squares(m)
// is the sum of squares over |r - c| = m, m = 0 ... n - 1.  A NaN at m gives a band of at least m.
Index smallest_band(const RealVector& squares, double tail) {
  double outside = 0.0;
  for (Index band = squares.size() - 1; band > 0; --band) {
    outside += squares(band);
    if (!(outside <= tail * tail)) return band;  // NaN included
  }
  return 0;
}

}  // namespace

template <class Real>
void cut_to_band(SplitMatrixOf<Real>& W, Index band, Share share) {
  if (share.is_first()) W.set_band(band);
  clear_between(W, band, W.size() - 1, share);
}

template <class Real>
void change_band(SplitMatrixOf<Real>& W, Index band) {
  const Index before = W.band();
  if (band < before) {
    parallel::for_each_share(
        1, W.size(), [&](std::size_t, Share share) { clear_between(W, band, before, share); });
  }
  W.set_band(band);
}

template <class Real>
void BandTruncation::truncate(std::span<SplitMatrixOf<Real>> X, Allowed allowed) {
  if (!enabled_) {
    for (SplitMatrixOf<Real>& each : X) each.set_band(each.size() - 1);
    return;
  }
  parallel::for_shares_of(X, [&](std::size_t k, Share share) {
    sum_over_diagonals(squares_[k], X[k], allowed.is_symmetric, share);
  });
  bool any_cut = false;
  for (std::size_t k = 0; k < X.size(); ++k) {
    const double tail = allowed.tail + allowed.part * std::sqrt(squares_[k].sum());
    cut_bands_[k] = smallest_band(squares_[k], tail);
    any_cut = any_cut || cut_bands_[k] < X[k].band();
  }
  if (any_cut) {
    parallel::for_shares_of(X, [&](std::size_t k, Share share) {
      clear_between(X[k], cut_bands_[k], X[k].band(), share);
    });
  }
  for (std::size_t k = 0; k < X.size(); ++k) X[k].set_band(cut_bands_[k]);
}

template <class Real>
double BandTruncation::measure_and_truncate_symmetric(SplitMatrixOf<Real>& X, double tail) {
  truncate_symmetric(X, tail);
  return enabled_ ? std::sqrt(squares_[0].sum()) : norm(X);
}

template <class Real>
void BandTruncation::measure_symmetric(RealVector& squares, const SplitMatrixOf<Real>& X) const {
  if (!enabled_) return;
  parallel::for_each_share(
      1, X.size(), [&](std::size_t, Share share) { sum_over_diagonals(squares, X, true, share); });
}

Index BandTruncation::band_of(const RealVector& squares, double tail) const {
  return enabled_ ? smallest_band(squares, tail) : squares.size() - 1;
}

void BandTruncation::truncate_skew(SplitStages& B, DiagonalSquares& squares, double tail) const {
  if (enabled_) {
    parallel::for_shares_of(
        B, [&](std::size_t k, Share share) { sum_over_diagonals(squares[k], B[k], true, share); });
  }
  parallel::for_shares_of(B, [&](std::size_t k, Share share) {
    const Index band = enabled_ ? smallest_band(squares[k], tail) : B[k].size() - 1;
    mirror_skew_within(B[k], band, share);
  });
}

void BandTruncation::round_skew(SingleStages& S, const SplitStages& B,
                                const DiagonalSquares& squares, double tail) const {
  round_to_single(S, B);
  if (!enabled_) return;
  parallel::for_shares_of(B, [&](std::size_t k, Share share) {
    cut_to_band(S[k], smallest_band(squares[k], tail), share);
  });
}

template void cut_to_band(SplitMatrix&, Index, Share);
template void cut_to_band(SingleMatrix&, Index, Share);
template void change_band(SplitMatrix&, Index);
template void change_band(SingleMatrix&, Index);
template void BandTruncation::truncate(std::span<SplitMatrix>, Allowed);
template void BandTruncation::truncate(std::span<SingleMatrix>, Allowed);
template void BandTruncation::measure_symmetric(RealVector&, const SplitMatrix&) const;
template double BandTruncation::measure_and_truncate_symmetric(SplitMatrix&, double);
template double BandTruncation::measure_and_truncate_symmetric(SingleMatrix&, double);

}  // namespace isosyrk
