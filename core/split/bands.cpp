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
// skew-Hermitian matrix only the upper triangle is read, and counts twice.
template <class Real>
void sum_over_diagonals(RealVector& squares, const SplitMatrixOf<Real>& W, bool is_skew,
                        Share share) {
  const Index n = W.size();
  const Index first = n * share.first / share.parts;
  const Index end = n * share.end / share.parts;
  const double weight = is_skew ? 2.0 : 1.0;
  squares.segment(first, end - first).setZero();
  for (Index i = 0; i < n; ++i) {
    const Index above = std::min(end, n - i);
    if (first < above) {
      squares.segment(first, above - first).array() +=
          weight * squares_in_row(W, i, i + first, above - first);
    }
    const Index nearest = std::max<Index>(first, 1);
    const Index below = std::min(end, i + 1);
    if (!is_skew && nearest < below) {
      squares.segment(nearest, below - nearest).array() +=
          squares_in_row(W, i, i - below + 1, below - nearest).reverse();
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
  const Index n = W.size();
  if (share.is_first()) W.set_band(band);
  if (band >= n - 1) return;
  const parallel::Rows rows = parallel::rows_of_share(n, share);
  for (Index i = rows.begin; i < rows.end; ++i) {
    for (Real* part : {W.re(), W.im()}) {
      Real* row = part + i * W.stride();
      if (i > band) std::fill(row, row + i - band, Real{0});
      if (i + band + 1 < n) std::fill(row + i + band + 1, row + n, Real{0});
    }
  }
}

template <class Real>
void BandTruncation::truncate(std::span<SplitMatrixOf<Real>> X, Allowed allowed) {
  if (!enabled_) {
    for (SplitMatrixOf<Real>& each : X) each.set_band(each.size() - 1);
    return;
  }
  parallel::for_shares_of(
      X, [&](std::size_t k, Share share) { sum_over_diagonals(squares_[k], X[k], false, share); });
  parallel::for_shares_of(X, [&](std::size_t k, Share share) {
    const double tail = allowed.tail + allowed.part * std::sqrt(squares_[k].sum());
    cut_to_band(X[k], smallest_band(squares_[k], tail), share);
  });
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
template void BandTruncation::truncate(std::span<SplitMatrix>, Allowed);
template void BandTruncation::truncate(std::span<SingleMatrix>, Allowed);

}  // namespace isosyrk
