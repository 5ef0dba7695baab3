// Packing: copies of panels of B, of columns of A and of the last column of B, in the order in
// which the micro-kernel and the edge case read them.
//
// Workspace of a range of rows: the last column of B takes 3 stride / 2 numbers, and the packed
// rows of A† follow.
#pragma once

#include "isosyrk/split/gemm_micro_kernel.h"

namespace isosyrk {
namespace {

// Returns `columns` rounded up to whole vectors.
template <class Real>
constexpr Index whole_vectors(Index columns) {
  return (columns + width<Real> - 1) / width<Real> * width<Real>;
}

// Returns the place of the packed panel that begins at column j.
template <class Real>
inline __attribute__((always_inline)) Real* packed_panel(const SplitProduct<Real>& product,
                                                         Index j) {
  return product.packed_B + 2 * j * product.n;
}

// Packs columns j ... j + columns - 1 of B: each row's real parts, then its imaginary parts.
template <class Real>
inline __attribute__((always_inline)) void pack_panel(const SplitProduct<Real>& product, Index j,
                                                      Index columns) {
  const Index vectors = (columns + width<Real> - 1) / width<Real>;
  const Range of_k = within_band(product.n, j, j + columns, product.B_band);
  Real* to = packed_panel(product, j) + 2 * vectors * width<Real> * of_k.begin;
  for (Index k = of_k.begin; k < of_k.end; ++k) {
    const Real* re = product.B_re + k * product.stride + j;
    const Real* im = product.B_im + k * product.stride + j;
    for (Index v = 0; v < vectors; ++v) {
      store(to + v * width<Real>, load(re + v * width<Real>));
      store(to + (vectors + v) * width<Real>, load(im + v * width<Real>));
    }
    to += 2 * vectors * width<Real>;
  }
}

// Packs rows i ... i + height - 1 of A†, which are columns of A: for each k the real parts, then
// the imaginary parts. `rows` are those rows in place.
template <class Real>
inline __attribute__((always_inline)) LeftFactor<Real> pack_adjoint_rows(
    const SplitProduct<Real>& product, const LeftFactor<Real>& rows, Index i, Index height,
    Real* to) {
  const Range of_k = within_band(product.n, i, i + height, product.A_band);
  for (Index k = of_k.begin; k < of_k.end; ++k) {
    for (Index r = 0; r < height; ++r) {
      to[2 * tile_rows * k + r] = rows.re[k * rows.column + r];
      to[2 * tile_rows * k + tile_rows + r] = rows.im[k * rows.column + r];
    }
  }
  return {to, to + tile_rows, 1, 2 * tile_rows};
}

// The rows in which the last column x + iy of B can be nonzero, from a multiple of half a vector's
// width on.
template <class Real>
inline Range rows_of_last_column(const SplitProduct<Real>& product) {
  constexpr Index half = width<Real> / 2;
  const Range of_k = within_band(product.n, product.n - 1, product.n, product.B_band);
  return {of_k.begin / half * half, of_k.end};
}

// Packs the last column x + iy of B for last_entries: half a vector of -y, of x and of y in turn,
// the last ones padded with 0. Single numbers are stored here and vectors loaded there. The tiles
// are formed in between, so that the loads need not wait for the stores.
template <class Real>
inline void pack_last_column(const SplitProduct<Real>& product, Real* to) {
  constexpr Index half = width<Real> / 2;
  const Range of_k = rows_of_last_column(product);
  const Real* x = product.B_re + of_k.begin * product.stride + product.n - 1;
  const Real* y = product.B_im + of_k.begin * product.stride + product.n - 1;
  to += 3 * of_k.begin;
  const auto copy = [&](Index rows) __attribute__((always_inline)) {
    for (Index k = 0; k < rows; ++k) {
      to[k] = -*y;
      to[half + k] = *x;
      to[2 * half + k] = *y;
      x += product.stride;
      y += product.stride;
    }
    for (Index k = rows; k < half; ++k) to[k] = to[half + k] = to[2 * half + k] = 0;
    to += 3 * half;
  };
  Index left = of_k.end - of_k.begin;
  for (; left >= half; left -= half) copy(half);
  if (left > 0) copy(left);
}

}  // namespace
}  // namespace isosyrk
