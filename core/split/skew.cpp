#include "isosyrk/split/skew.h"

#include <algorithm>
#include <cmath>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/small_blocks.h"

namespace isosyrk {
namespace {

// Returns the column c such that part / parts of the upper triangle lies left of c, rounded down to
// a multiple of `of_block`.
Index first_column(Index n, Index part, Index parts, Index of_block) {
  if (part == parts) return n;
  const double share = static_cast<double>(part) / static_cast<double>(parts);
  return static_cast<Index>(static_cast<double>(n) * std::sqrt(share)) / of_block * of_block;
}

// Visits the entries of a share within a band, by their places in C:
//   block(upper, lower) for the Blocks at (r, c) and (c, r), r < c, that lie in the band;
//   pair(upper, lower) for all other entries (r, c) and (c, r), r < c: in blocks on the diagonal or
//     across the edge of the band, and in the last columns if they are fewer than a block has;
//   on_diagonal(place) for (r, r).
template <class Real, class OnBlock, class OnPair, class OnDiagonal>
void for_pairs(const SplitMatrixOf<Real>& C, Index band, Share share, OnBlock&& block,
               OnPair&& pair, OnDiagonal&& on_diagonal) {
  const Index n = C.size();
  const Index stride = C.stride();
  constexpr Index size = Block<Real>::size;
  const Index begin = first_column(n, share.first, share.parts, size);
  const Index end = first_column(n, share.end, share.parts, size);
  const auto pair_at = [&](Index r, Index c) { pair(r * stride + c, c * stride + r); };
  Index c = begin;
  for (; c + size <= end; c += size) {
    const Index first = std::max<Index>(0, c - (size - 1) - band);  // row that reaches the band
    Index r = first / size * size;
    for (; r < c && c + (size - 1) - r > band; r += size) {
      for (Index i = r; i < r + size; ++i) {
        for (Index k = c; k < std::min(c + size, i + band + 1); ++k) pair_at(i, k);
      }
    }
    for (; r < c; r += size) block(r * stride + c, c * stride + r);
    for (Index i = c; i < c + size; ++i) {
      for (Index k = i + 1; k < c + size; ++k) {
        if (k - i <= band) pair_at(i, k);
      }
    }
  }
  for (; c < end; ++c) {
    for (Index r = std::max<Index>(0, c - band); r < c; ++r) pair_at(r, c);
  }
  for (Index i = begin; i < end; ++i) on_diagonal(i * stride + i);
}

// Stores the transpose of a block, or its negative.
template <class Real>
inline __attribute__((always_inline)) void turn(const Real* from, Real* to, Index stride,
                                                bool negative) {
  Block<Real> block;
  block.load(from, stride);
  if (negative) {
    for (Lanes<Real>& row : block.row) row = -row;
  }
  block.transpose();
  block.store(to, stride);
}

// Fills the lower triangle of a Hermitian matrix within a band, in a share.
template <class Real>
void mirror_hermitian(SplitMatrixOf<Real>& C, Index band, Share share) {
  const Index stride = C.stride();
  Real* re = C.re();
  Real* im = C.im();
  for_pairs(
      C, band, share,
      [=](Index upper, Index lower) {
        turn(re + upper, re + lower, stride, false);
        turn(im + upper, im + lower, stride, true);
      },
      [=](Index upper, Index lower) {
        re[lower] = re[upper];
        im[lower] = -im[upper];
      },
      [=](Index at) { im[at] = 0; });
}

// Fills the lower triangle of a skew-Hermitian matrix within a band, in a share.
template <class Real>
void mirror(SplitMatrixOf<Real>& C, Index band, Share share) {
  const Index stride = C.stride();
  Real* re = C.re();
  Real* im = C.im();
  for_pairs(
      C, band, share,
      [=](Index upper, Index lower) {
        turn(re + upper, re + lower, stride, true);
        turn(im + upper, im + lower, stride, false);
      },
      [=](Index upper, Index lower) {
        re[lower] = -re[upper];
        im[lower] = im[upper];
      },
      [=](Index at) { re[at] = 0; });
}

// out = scale (C - C†) within a band, in the upper triangle and, if `below`, in the lower one.
template <bool below, class Real>
void form_skew_part(SplitMatrixOf<Real>& out, Index band, const SplitMatrixOf<Real>& C, Real scale,
                    Share share) {
  const Index stride = C.stride();
  const Real* re = C.re();
  const Real* im = C.im();
  Real* out_re = out.re();
  Real* out_im = out.im();
  // Of the real parts scale (X - Xᵀ), of the imaginary ones scale (X + Xᵀ), in two blocks.
  const auto form = [=](const Real* from, Real* to, Index upper, Index lower, Real sign) {
    Block<Real> sum, other;
    sum.load(from + upper, stride);
    other.load(from + lower, stride);
    other.transpose();
    for (int r = 0; r < Block<Real>::size; ++r) {
      sum.row[r] = scale * (sum.row[r] + sign * other.row[r]);
    }
    sum.store(to + upper, stride);
    if constexpr (below) {
      for (Lanes<Real>& row : sum.row) row = sign * row;
      sum.transpose();
      sum.store(to + lower, stride);
    }
  };
  for_pairs(
      C, band, share,
      [=](Index upper, Index lower) {
        form(re, out_re, upper, lower, Real{-1});
        form(im, out_im, upper, lower, Real{1});
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

// out = -C† in a share.
template <class Real>
void minus_adjoint(SplitMatrixOf<Real>& out, const SplitMatrixOf<Real>& C, Share share) {
  const Index stride = C.stride();
  const Real* re = C.re();
  const Real* im = C.im();
  Real* out_re = out.re();
  Real* out_im = out.im();
  for_pairs(
      C, C.size() - 1, share,
      [=](Index upper, Index lower) {
        turn(re + lower, out_re + upper, stride, true);
        turn(re + upper, out_re + lower, stride, true);
        turn(im + lower, out_im + upper, stride, false);
        turn(im + upper, out_im + lower, stride, false);
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

}  // namespace

template <class Real>
void mirror_skew(SplitMatrixOf<Real>& C, Share share) {
  mirror(C, C.size() - 1, share);
}

template <class Real>
void mirror_skew_within(SplitMatrixOf<Real>& C, Index band, Share share) {
  mirror(C, band, share);
  cut_to_band(C, band, share);
}

template <class Real>
void mirror_skew(SplitStagesOf<Real>& C) {
  parallel::for_shares_of(C, [&](std::size_t i, Share share) { mirror_skew(C[i], share); });
}

template <class Real>
void mirror_skew_within(SplitStagesOf<Real>& C, Index band) {
  parallel::for_shares_of(
      C, [&](std::size_t i, Share share) { mirror_skew_within(C[i], band, share); });
}

template <class Real>
void skew_part(SplitStagesOf<Real>& out, const SplitStagesOf<Real>& C, double scale) {
  parallel::for_shares_of(C, [&](std::size_t i, Share share) {
    form_skew_part<true>(out[i], C[i].size() - 1, C[i], static_cast<Real>(scale), share);
    if (share.is_first()) out[i].set_band(C[i].band());
  });
}

template <class Real>
void upper_skew_part_within(SplitStagesOf<Real>& out, Index band, const SplitStagesOf<Real>& C) {
  parallel::for_shares_of(C, [&](std::size_t i, Share share) {
    form_skew_part<false>(out[i], band, C[i], Real{1}, share);
  });
}

template <class Real>
void minus_adjoint(SplitStagesOf<Real>& out, const SplitStagesOf<Real>& C) {
  parallel::for_shares_of(C, [&](std::size_t i, Share share) {
    minus_adjoint(out[i], C[i], share);
    if (share.is_first()) out[i].set_band(C[i].band());
  });
}

template <class Real>
void skew_part(SplitMatrixOf<Real>& out, const SplitMatrixOf<Real>& C, double scale) {
  const Index band = C.band();
  parallel::for_each_share(1, C.size(), [&](std::size_t, Share share) {
    form_skew_part<true>(out, band, C, static_cast<Real>(scale), share);
  });
  change_band(out, band);
}

template <class Real>
void mirror_all_skew(SplitMatrixOf<Real>& C) {
  const Index band = C.band();
  parallel::for_each_share(1, C.size(),
                           [&](std::size_t, Share share) { mirror_skew_within(C, band, share); });
}

template <class Real>
void mirror_skew_in_band(SplitMatrixOf<Real>& C) {
  parallel::for_each_share(1, C.size(),
                           [&](std::size_t, Share share) { mirror(C, C.band(), share); });
}

template <class Real>
void mirror_all_hermitian(SplitMatrixOf<Real>& C) {
  const Index band = C.band();
  parallel::for_each_share(1, C.size(), [&](std::size_t, Share share) {
    mirror_hermitian(C, band, share);
    cut_to_band(C, band, share);
  });
}

template void skew_part(SplitMatrix&, const SplitMatrix&, double);
template void skew_part(SingleMatrix&, const SingleMatrix&, double);
template void mirror_all_skew(SplitMatrix&);
template void mirror_all_skew(SingleMatrix&);
template void mirror_skew_in_band(SplitMatrix&);
template void mirror_skew_in_band(SingleMatrix&);
template void mirror_all_hermitian(SplitMatrix&);
template void mirror_all_hermitian(SingleMatrix&);
template void mirror_skew(SplitMatrix&, Share);
template void mirror_skew(SingleMatrix&, Share);
template void mirror_skew_within(SplitMatrix&, Index, Share);
template void mirror_skew_within(SingleMatrix&, Index, Share);
template void mirror_skew(SplitStages&);
template void mirror_skew(SingleStages&);
template void mirror_skew_within(SplitStages&, Index);
template void mirror_skew_within(SingleStages&, Index);
template void skew_part(SplitStages&, const SplitStages&, double);
template void skew_part(SingleStages&, const SingleStages&, double);
template void upper_skew_part_within(SingleStages&, Index, const SingleStages&);
template void minus_adjoint(SplitStages&, const SplitStages&);
template void minus_adjoint(SingleStages&, const SingleStages&);

}  // namespace isosyrk
