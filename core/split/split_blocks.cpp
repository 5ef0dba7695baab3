#include "isosyrk/split/split_blocks.h"

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
// and pair(upper, lower) with those of single entries of what is left, the diagonal's blocks, those
// at the edge of the band and the last rows that are less than four; and on_diagonal(place); of all
// within a band, or of a share of them.
template <class Real, class OnBlock, class OnPair, class OnDiagonal>
void for_pairs(const PlanarMatrixOf<Real>& C, Index band, Share share, OnBlock&& block,
               OnPair&& pair, OnDiagonal&& on_diagonal) {
  const Index n = C.size();
  const Index stride = C.stride();
  const Index begin = first_column(n, share.part, share.parts);
  const Index end = first_column(n, share.part + 1, share.parts);
  const auto pair_at = [&](Index r, Index c) { pair(r * stride + c, c * stride + r); };
  Index c = begin;
  for (; c + 4 <= end; c += 4) {
    Index r = std::max<Index>(0, c - 3 - band) / 4 * 4;  // the first block that reaches the band
    for (; r < c && c + 3 - r > band; r += 4) {
      for (Index i = r; i < r + 4; ++i) {
        for (Index k = c; k < std::min(c + 4, i + band + 1); ++k) pair_at(i, k);
      }
    }
    for (; r < c; r += 4) block(r * stride + c, c * stride + r);
    for (Index i = c; i < c + 4; ++i) {
      for (Index k = i + 1; k < c + 4; ++k) {
        if (k - i <= band) pair_at(i, k);
      }
    }
  }
  for (; c < end; ++c) {
    for (Index r = std::max<Index>(0, c - band); r < c; ++r) pair_at(r, c);
  }
  for (Index i = begin; i < end; ++i) on_diagonal(i * stride + i);
}

}  // namespace

namespace {

template <class Real>
void mirror(Index band, PlanarMatrixOf<Real>& C, Share share) {
  const Index stride = C.stride();
  Real* re = C.re();
  Real* im = C.im();
  for_pairs(
      C, band, share,
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

}  // namespace

template <class Real>
void mirror_skew(PlanarMatrixOf<Real>& C, Share share) {
  mirror(C.size() - 1, C, share);
}

template <class Real>
void mirror_skew_within(Index band, PlanarMatrixOf<Real>& C, Share share) {
  mirror(band, C, share);
  cut_to_band(band, C, share);
}

namespace {

// scale (C - C†) within a band, above the diagonal and, if asked for, below it.
template <bool below, class Real>
void form_skew_part(Index band, const PlanarMatrixOf<Real>& C, Real scale,
                    PlanarMatrixOf<Real>& out, Share share) {
  const Index stride = C.stride();
  const Real* re = C.re();
  const Real* im = C.im();
  Real* out_re = out.re();
  Real* out_im = out.im();
  for_pairs(
      C, band, share,
      [=](Index upper, Index lower) {
        Block<Real> sum, other;
        sum.load(re + upper, stride);
        other.load(re + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] - other.row[r]);
        sum.store(out_re + upper, stride);
        if constexpr (below) {
          for (Four<Real>& row : sum.row) row = -row;
          sum.transpose();
          sum.store(out_re + lower, stride);
        }
        sum.load(im + upper, stride);
        other.load(im + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] + other.row[r]);
        sum.store(out_im + upper, stride);
        if constexpr (below) {
          sum.transpose();
          sum.store(out_im + lower, stride);
        }
      },
      [=](Index upper, Index lower) {
        const Real real = scale * (re[upper] - re[lower]);
        const Real imaginary = scale * (im[upper] + im[lower]);
        out_re[upper] = real;
        out_im[upper] = imaginary;
        if constexpr (below) {
          out_re[lower] = -real;
          out_im[lower] = imaginary;
        }
      },
      [=](Index at) {
        out_re[at] = 0;
        out_im[at] = 2 * scale * im[at];
      });
}

}  // namespace

template <class Real>
void skew_part(const PlanarMatrixOf<Real>& C, std::type_identity_t<Real> scale,
               PlanarMatrixOf<Real>& out, Share share) {
  form_skew_part<true>(C.size() - 1, C, scale, out, share);
}

template <class Real>
void upper_skew_part_within(Index band, const PlanarMatrixOf<Real>& C, PlanarMatrixOf<Real>& out,
                            Share share) {
  form_skew_part<false>(band, C, Real{1}, out, share);
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
      C, C.size() - 1, share,
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

template <class Real>
void subtract_adjoint(const PlanarMatrixOf<Real>& C, std::type_identity_t<Real> scale,
                      PlanarMatrixOf<Real>& out, Share share) {
  const Index n = C.size();
  const Index stride = C.stride();
  const auto add_block = [stride](const Real* from, Real factor, Real* to) {
    Block<Real> block, sum;
    block.load(from, stride);
    block.transpose();
    sum.load(to, stride);
    for (int r = 0; r < 4; ++r) sum.row[r] += factor * block.row[r];
    sum.store(to, stride);
  };
  const auto add_entry = [&](Index r, Index c) {
    out.re()[r * stride + c] -= scale * C.re()[c * stride + r];
    out.im()[r * stride + c] += scale * C.im()[c * stride + r];
  };
  const Rows rows(n, share);
  Index r = rows.begin;
  for (; r + 4 <= rows.end; r += 4) {
    Index c = 0;
    for (; c + 4 <= n; c += 4) {
      add_block(C.re() + c * stride + r, -scale, out.re() + r * stride + c);
      add_block(C.im() + c * stride + r, scale, out.im() + r * stride + c);
    }
    for (; c < n; ++c) {
      for (Index i = r; i < r + 4; ++i) add_entry(i, c);
    }
  }
  for (; r < rows.end; ++r) {
    for (Index c = 0; c < n; ++c) add_entry(r, c);
  }
}

namespace {

// Columns first ... first + count - 1 of a row of both parts, squared.
template <class Real>
auto squares_in_row(const PlanarMatrixOf<Real>& W, Index row, Index first, Index count) {
  const auto of = [&](const Real* part) {
    using Row = Eigen::Array<Real, Eigen::Dynamic, 1>;
    return Eigen::Map<const Row>(part + row * W.stride() + first, count)
        .template cast<double>()
        .square();
  };
  return of(W.re()) + of(W.im());
}

}  // namespace

template <class Real>
void diagonal_squares(const PlanarMatrixOf<Real>& W, RealVector& squares, Share share) {
  const Index n = W.size();
  squares.setZero();
  const Rows rows(n, share);
  for (Index i = rows.begin; i < rows.end; ++i) {
    squares.head(n - i).array() += squares_in_row(W, i, i, n - i);
    squares.segment(1, i).array() += squares_in_row(W, i, 0, i).reverse();
  }
}

void diagonal_squares_of_skew(const PlanarMatrix& W, Index first, Index end, RealVector& squares) {
  const Index n = W.size();
  squares.segment(first, end - first).setZero();
  for (Index i = 0; i + first < n; ++i) {
    const Index count = std::min(n - i, end) - first;
    squares.segment(first, count).array() += 2.0 * squares_in_row(W, i, i + first, count);
  }
}

template <class Real>
void cut_to_band(Index band, PlanarMatrixOf<Real>& W, Share share) {
  const Index n = W.size();
  if (share.is_first()) W.set_band(band);
  if (band >= n - 1) return;
  const Rows rows(n, share);
  for (Index i = rows.begin; i < rows.end; ++i) {
    for (Real* part : {W.re(), W.im()}) {
      Real* row = part + i * W.stride();
      if (i > band) std::fill(row, row + i - band, Real{0});
      if (i + band + 1 < n) std::fill(row + i + band + 1, row + n, Real{0});
    }
  }
}

template void diagonal_squares(const PlanarMatrix&, RealVector&, Share);
template void diagonal_squares(const SingleMatrix&, RealVector&, Share);
template void cut_to_band(Index, PlanarMatrix&, Share);
template void cut_to_band(Index, SingleMatrix&, Share);
template void mirror_skew(PlanarMatrix&, Share);
template void mirror_skew(SingleMatrix&, Share);
template void mirror_skew_within(Index, PlanarMatrix&, Share);
template void mirror_skew_within(Index, SingleMatrix&, Share);
template void skew_part(const PlanarMatrix&, double, PlanarMatrix&, Share);
template void skew_part(const SingleMatrix&, float, SingleMatrix&, Share);
template void upper_skew_part_within(Index, const SingleMatrix&, SingleMatrix&, Share);
template void minus_adjoint(const SingleMatrix&, SingleMatrix&, Share);
template void subtract_adjoint(const PlanarMatrix&, double, PlanarMatrix&, Share);
template void subtract_adjoint(const SingleMatrix&, float, SingleMatrix&, Share);

}  // namespace isosyrk
