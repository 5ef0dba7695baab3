#include "core/planar_blocks.h"

#include <algorithm>
#include <cmath>

namespace isosyrk {
namespace {

// Where a share of the upper triangle begins, a column that a block of four begins at: left of it
// lie part / parts of all entries.
Index first_column(Index n, Index part, Index parts) {
  if (part == parts) return n;
  const double share = static_cast<double>(part) / static_cast<double>(parts);
  return static_cast<Index>(static_cast<double>(n) * std::sqrt(share)) / 4 * 4;
}

// Calls block(upper, lower) with the places of the blocks of four rows at (r, c) and (c, r), r < c,
// and pair(upper, lower) with those of single entries of what is left, the diagonal's blocks and
// the last rows that are less than four; and on_diagonal(place); of all, or of a share of them.
template <class Real, class OnBlock, class OnPair, class OnDiagonal>
void for_pairs(const PlanarMatrixOf<Real>& C, Share share, OnBlock&& block, OnPair&& pair,
               OnDiagonal&& on_diagonal) {
  const Index n = C.size();
  const Index stride = C.stride();
  const Index begin = first_column(n, share.part, share.parts);
  const Index end = first_column(n, share.part + 1, share.parts);
  Index c = begin;
  for (; c + 4 <= end; c += 4) {
    for (Index r = 0; r < c; r += 4) block(r * stride + c, c * stride + r);
    for (Index i = c; i < c + 4; ++i) {
      for (Index k = i + 1; k < c + 4; ++k) pair(i * stride + k, k * stride + i);
    }
  }
  for (; c < end; ++c) {
    for (Index r = 0; r < c; ++r) pair(r * stride + c, c * stride + r);
  }
  for (Index i = begin; i < end; ++i) on_diagonal(i * stride + i);
}

}  // namespace

template <class Real>
void mirror_skew(PlanarMatrixOf<Real>& C, Share share) {
  const Index stride = C.stride();
  Real* re = C.re();
  Real* im = C.im();
  for_pairs(
      C, share,
      [=](Index upper, Index lower) {
        Block<Real> block;
        block.load(re + upper, stride);
        for (Four<Real>& row : block.row) row = -row;
        block.transpose();
        block.store(re + lower, stride);
        block.load(im + upper, stride);
        block.transpose();
        block.store(im + lower, stride);
      },
      [=](Index upper, Index lower) {
        re[lower] = -re[upper];
        im[lower] = im[upper];
      },
      [=](Index at) { re[at] = 0; });
}

template <class Real>
void skew_part(const PlanarMatrixOf<Real>& C, std::type_identity_t<Real> scale,
               PlanarMatrixOf<Real>& out, Share share) {
  const Index stride = C.stride();
  const Real* re = C.re();
  const Real* im = C.im();
  Real* out_re = out.re();
  Real* out_im = out.im();
  for_pairs(
      C, share,
      [=](Index upper, Index lower) {
        Block<Real> sum, other;
        sum.load(re + upper, stride);
        other.load(re + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] - other.row[r]);
        sum.store(out_re + upper, stride);
        for (Four<Real>& row : sum.row) row = -row;
        sum.transpose();
        sum.store(out_re + lower, stride);
        sum.load(im + upper, stride);
        other.load(im + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] + other.row[r]);
        sum.store(out_im + upper, stride);
        sum.transpose();
        sum.store(out_im + lower, stride);
      },
      [=](Index upper, Index lower) {
        const Real real = scale * (re[upper] - re[lower]);
        const Real imaginary = scale * (im[upper] + im[lower]);
        out_re[upper] = real;
        out_re[lower] = -real;
        out_im[upper] = out_im[lower] = imaginary;
      },
      [=](Index at) {
        out_re[at] = 0;
        out_im[at] = 2 * scale * im[at];
      });
}

template <class Real>
void minus_adjoint(const PlanarMatrixOf<Real>& C, PlanarMatrixOf<Real>& out, Share share) {
  const Index stride = C.stride();
  const Real* re = C.re();
  const Real* im = C.im();
  Real* out_re = out.re();
  Real* out_im = out.im();
  const auto turn = [stride](const Real* from, Real* to, bool negative) {
    Block<Real> block;
    block.load(from, stride);
    if (negative) {
      for (Four<Real>& row : block.row) row = -row;
    }
    block.transpose();
    block.store(to, stride);
  };
  for_pairs(
      C, share,
      [=](Index upper, Index lower) {
        turn(re + lower, out_re + upper, true);
        turn(re + upper, out_re + lower, true);
        turn(im + lower, out_im + upper, false);
        turn(im + upper, out_im + lower, false);
      },
      [=](Index upper, Index lower) {
        out_re[upper] = -re[lower];
        out_re[lower] = -re[upper];
        out_im[upper] = im[lower];
        out_im[lower] = im[upper];
      },
      [=](Index at) {
        out_re[at] = -re[at];
        out_im[at] = im[at];
      });
}

namespace {

// From the squares of the diagonals.
Index band_by(const RealVector& squares, double tail) {
  double outside = 0.0;
  for (Index band = squares.size() - 1; band > 0; --band) {
    outside += squares(band);
    if (!(outside <= tail * tail)) return band;  // NaN included
  }
  return 0;
}

// Row i of both planes from the diagonal on, squared.
template <class Real>
auto upper_squares(const PlanarMatrixOf<Real>& W, Index i) {
  const auto row = [&](const Real* plane) {
    using Row = Eigen::Array<Real, Eigen::Dynamic, 1>;
    return Eigen::Map<const Row>(plane + i * W.stride() + i, W.size() - i)
        .template cast<double>()
        .square();
  };
  return row(W.re()) + row(W.im());
}

// The same up to the diagonal.
template <class Real>
auto lower_squares(const PlanarMatrixOf<Real>& W, Index i) {
  const auto row = [&](const Real* plane) {
    using Row = Eigen::Array<Real, Eigen::Dynamic, 1>;
    return Eigen::Map<const Row>(plane + i * W.stride(), i).template cast<double>().square();
  };
  return row(W.re()) + row(W.im());
}

}  // namespace

template <class Real>
Index band_of(const PlanarMatrixOf<Real>& W, double tail, RealVector& squares) {
  const Index n = W.size();
  squares.setZero();
  for (Index i = 0; i < n; ++i) {
    squares.head(n - i).array() += upper_squares(W, i);
    squares.segment(1, i).array() += lower_squares(W, i).reverse();
  }
  return band_by(squares, tail);
}

Index band_of_skew(const PlanarMatrix& W, double tail, RealVector& squares) {
  const Index n = W.size();
  squares.setZero();
  for (Index i = 0; i < n; ++i) squares.head(n - i).array() += 2.0 * upper_squares(W, i);
  return band_by(squares, tail);
}

template <class Real>
void cut_to_band(Index band, PlanarMatrixOf<Real>& W) {
  const Index n = W.size();
  W.set_band(band);
  if (band >= n - 1) return;
  for (Real* plane : {W.re(), W.im()}) {
    for (Index i = 0; i < n; ++i) {
      Real* row = plane + i * W.stride();
      if (i > band) std::fill(row, row + i - band, Real{0});
      if (i + band + 1 < n) std::fill(row + i + band + 1, row + n, Real{0});
    }
  }
}

template Index band_of(const PlanarMatrix&, double, RealVector&);
template Index band_of(const SingleMatrix&, double, RealVector&);
template void cut_to_band(Index, PlanarMatrix&);
template void cut_to_band(Index, SingleMatrix&);
template void mirror_skew(PlanarMatrix&, Share);
template void mirror_skew(SingleMatrix&, Share);
template void skew_part(const PlanarMatrix&, double, PlanarMatrix&, Share);
template void skew_part(const SingleMatrix&, float, SingleMatrix&, Share);
template void minus_adjoint(const PlanarMatrix&, PlanarMatrix&, Share);
template void minus_adjoint(const SingleMatrix&, SingleMatrix&, Share);

}  // namespace isosyrk
