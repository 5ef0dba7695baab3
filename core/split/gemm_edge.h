// Edge case: a single column of C beyond a whole number of vectors, as for n = 16 k + 1. It is a
// matrix times a vector: A (x + iy) or A† (x + iy) with the last column x + iy of B.
#pragma once

#include "isosyrk/split/gemm_packing.h"

namespace isosyrk {
namespace {

// True if n leaves a single column beyond whole vectors.
template <class Real>
inline bool has_last_column(Index n) {
  return n > 1 && n % Index{width<Real>} == 1;
}

template <int... lanes>
struct Lanes {};
template <int count, int... lanes>
struct FirstLanes {
  using type = typename FirstLanes<count - 1, count - 1, lanes...>::type;
};
template <int... lanes>
struct FirstLanes<0, lanes...> {
  using type = Lanes<lanes...>;
};

// In lane l the sum of lanes l and l ^ distance: of `a` where l has that bit clear, of `b` where it
// is set.
template <class Real, int distance, int... lanes>
inline __attribute__((always_inline)) Vector<Real> sums_of_pairs(Vector<Real> a, Vector<Real> b,
                                                                 Lanes<lanes...>) {
  return __builtin_shufflevector(
             a, b, ((lanes & distance) != 0 ? (lanes ^ distance) + width<Real> : lanes)...) +
         __builtin_shufflevector(
             a, b, ((lanes & distance) != 0 ? lanes + width<Real> : (lanes ^ distance))...);
}

// In each half of the result, lane l: the sum over that half of vector l modulo `count`. `count` is
// a power of two up to half the width.
template <class Real, int count, int distance = 1>
inline __attribute__((always_inline)) Vector<Real> sums_over_halves(const Vector<Real>* vectors) {
  if constexpr (distance == width<Real> / 2) {
    static_assert(count == 1);
    return vectors[0];
  } else {
    constexpr int pairs = count > 1 ? count / 2 : 1;
    Vector<Real> sums[pairs];
#pragma GCC unroll 4
    for (int p = 0; p < pairs; ++p) {
      sums[p] = sums_of_pairs<Real, distance>(vectors[count > 1 ? 2 * p : 0],
                                              vectors[count > 1 ? 2 * p + 1 : 0],
                                              typename FirstLanes<width<Real>>::type());
    }
    return sums_over_halves<Real, pairs, 2 * distance>(sums);
  }
}

// Stores entries i ... i + rows - 1 of C's last column. The sum over the first half of sums[r] is
// the real part, over the second half the imaginary part. Up to four entries are reduced together.
template <int rows, class Real>
inline __attribute__((always_inline)) void store_last_entries(const SplitProduct<Real>& product,
                                                              const Vector<Real>* sums, Index i) {
  constexpr int half = width<Real> / 2;
  constexpr int most = rows < half ? rows : half;
  constexpr int together = most >= 4 ? 4 : most >= 2 ? 2 : 1;
  Real entries[width<Real>];
  store(entries, product.scale * sums_over_halves<Real, together>(sums));
#pragma GCC unroll 4
  for (int r = 0; r < together; ++r) {
    const Index at = (i + r) * product.stride + product.n - 1;
    product.C_re[at] = entries[r];
    product.C_im[at] = entries[half + r];
  }
  if constexpr (rows > together) {
    store_last_entries<rows - together>(product, sums + together, i + together);
  }
}

// Entries i ... i + rows - 1 of A (x + iy), as inner products with rows of A. Half a vector of A's
// real parts multiplies [x, y], half a vector of its imaginary parts [-y, x].
template <int rows, class Real>
__attribute__((noinline)) void last_entries(const SplitProduct<Real>& product, Index i,
                                            const Real* column) {
  constexpr Index half = width<Real> / 2;
  const RowSteps steps(product.stride);
  const Range of_A = within_band(product.n, i, i + rows, product.A_band);
  const Range of_B = rows_of_last_column(product);
  const Index begin = greater(of_A.begin / half * half, of_B.begin);
  const Index end = smaller(of_A.end, of_B.end);
  const Real* A_re = product.A_re + i * product.stride + begin;
  const Real* A_im = product.A_im + i * product.stride + begin;
  column += 3 * begin;
  Vector<Real> sums[rows] = {};
  Vector<Real> sums_of_im[rows] = {};
  for (Index k = begin; k < end; k += half) {
    const Vector<Real> minus_y_x = load(column);
    const Vector<Real> x_y = load(column + half);
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r) {
      sums[r] += half_twice(A_re + steps[r]) * x_y;
      sums_of_im[r] += half_twice(A_im + steps[r]) * minus_y_x;
    }
    A_re += half;
    A_im += half;
    column += 3 * half;
    keep(A_re);
    keep(A_im);
    keep(column);
  }
#pragma GCC unroll 8
  for (int r = 0; r < rows; ++r) sums[r] += sums_of_im[r];
  store_last_entries<rows>(product, sums, i);
}

// Forms entries i ... i + rows - 1 of A (x + iy) if they are needed. Forms none of A† (x + iy):
// last_column_of_adjoint does.
template <bool adjoint, class Real>
void form_last_entries(Index rows, const SplitProduct<Real>& product, Index i, const Real* column) {
  if (adjoint || unneeded(product, i, rows, product.n - 1, 1)) return;
  with_height(rows, [&]<int height>(Height<height>) { last_entries<height>(product, i, column); });
}

// Entries of A† (x + iy) from i on, as many as `vectors` vectors hold, into re and im.
template <int vectors, class Real>
inline __attribute__((always_inline)) void last_entries_of_adjoint(
    const SplitProduct<Real>& product, Index i, Real* re, Real* im) {
  const Index n = product.n;
  const Index stride = product.stride;
  Vector<Real> ax[vectors] = {}, by[vectors] = {}, ay[vectors] = {}, bx[vectors] = {};
  const Range of_k = nonzero_terms(product, i, vectors * width<Real>, n - 1, 1);
  for (Index k = of_k.begin * stride; k < of_k.end * stride; k += stride) {
    keep(k);
    const Real x = product.B_re[k + n - 1];
    const Real y = product.B_im[k + n - 1];
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      const Vector<Real> a = load(product.A_re + k + i + v * width<Real>);
      const Vector<Real> b = load(product.A_im + k + i + v * width<Real>);
      ax[v] += a * x;
      by[v] += b * y;
      ay[v] += a * y;
      bx[v] += b * x;
    }
  }
#pragma GCC unroll 4
  for (int v = 0; v < vectors; ++v) {
    store(re + i + v * width<Real>, product.scale * (ax[v] + by[v]));
    store(im + i + v * width<Real>, product.scale * (ay[v] - bx[v]));
  }
}

// The entries of A† (x + iy) in `rows`, as far as C_band needs them: a linear combination of rows
// of A. Whole vectors are summed in the workspace; the padding of A allows it.
template <class Real>
inline void last_column_of_adjoint(const SplitProduct<Real>& product, Range rows, Real* scratch) {
  const Index first = greater(rows.begin, product.n - 1 - product.C_band);
  const Index end = rows.end;
  Real* re = scratch;
  Real* im = scratch + product.stride / 2;
  Index i = first / width<Real> * width<Real>;
  for (; i + 2 * width<Real> < end; i += 3 * width<Real>) {
    last_entries_of_adjoint<3>(product, i, re, im);
  }
  if (i + width<Real> < end) {
    last_entries_of_adjoint<2>(product, i, re, im);
  } else if (i < end) {
    last_entries_of_adjoint<1>(product, i, re, im);
  }
  for (i = first; i < end; ++i) {
    keep(i);
    product.C_re[i * product.stride + product.n - 1] = re[i];
    product.C_im[i * product.stride + product.n - 1] = im[i];
  }
}

}  // namespace
}  // namespace isosyrk
