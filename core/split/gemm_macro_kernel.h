// Macro-kernel: the loops over panels of B and blocks of rows of A, and the rows that a share of
// the product forms.
#pragma once

#include "isosyrk/split/gemm_edge.h"

namespace isosyrk {
namespace {

// Cuts the rows first ... end - 1 into blocks of nearly equal height and calls tiles(first row,
// height). A last block of few rows would have too few independent sums to hide the latency of a
// multiply-add.
template <class Tiles>
inline __attribute__((always_inline)) void for_row_blocks(Index first, Index end, Tiles&& tiles) {
  const Index blocks = (end - first + tile_rows - 1) / tile_rows;
  Index i = first;
  for (Index block = 0; block < blocks; ++block) {
    const Index height = (end - i) / (blocks - block);
    tiles(i, height);
    i += height;
  }
}

// Calls panel(tile columns, first column, number of columns) for all columns except a single last
// one.
template <class Real, class Visit>
inline __attribute__((always_inline)) void for_panels(Index n, Visit&& panel) {
  constexpr Index columns = tile_vectors * width<Real>;
  Index j = 0;
  for (; j + columns <= n; j += columns) panel(TileColumns::all_vectors, j, columns);
  for (; j + width<Real> <= n; j += width<Real>) {
    panel(TileColumns::one_vector, j, Index{width<Real>});
  }
  if (j < n && !has_last_column<Real>(n)) panel(TileColumns::part_of_vector, j, n - j);
}

// For matrices that fit into the caches: reads the panels of B in place. The entries of a single
// last column are formed between the tiles of the last panel, whose sums are independent of them.
template <bool adjoint, class Real>
void multiply_in_place(const SplitProduct<Real>& product, Range rows, const LeftFactor<Real>& A) {
  for_panels<Real>(product.n, [&](TileColumns kind, Index j, Index columns) {
    const Panel<Real> B{product.B_re + j, product.B_im + j, product.stride};
    const Index end = product.upper ? smaller(j + columns, rows.end) : rows.end;
    const bool column_follows = j + columns + 1 == product.n;
    for_row_blocks(rows.begin, end, [&](Index i, Index height) {
      if (!unneeded(product, i, height, j, columns)) {
        form_tile<adjoint>(height, kind, product, rows_from(A, i), B, i, j);
      }
      if (column_follows) form_last_entries<adjoint>(height, product, i);
    });
    if (!column_follows) return;
    for (Index i = greater(end, rows.begin); i < rows.end; ++i) {
      form_last_entries<adjoint>(1, product, i);
    }
  });
}

// For larger matrices: a block of rows of A stays in the first-level cache while the packed panels
// of B stream from the second-level cache.
template <bool adjoint, class Real>
void multiply_packed(const SplitProduct<Real>& product, Range rows, const LeftFactor<Real>& A) {
  const Index n = product.n;
  for_panels<Real>(n,
                   [&](TileColumns, Index j, Index columns) { pack_panel(product, j, columns); });
  for_row_blocks(rows.begin, rows.end, [&](Index i, Index height) {
    LeftFactor<Real> block = rows_from(A, i);
    if (adjoint && product.packs_adjoint_A) block = pack_adjoint_rows(product, block, i, height);
    for_panels<Real>(n, [&](TileColumns kind, Index j, Index columns) {
      if (unneeded(product, i, height, j, columns)) return;
      const Index whole = whole_vectors<Real>(columns);
      const Real* B = packed_panel(product, j);
      form_tile<adjoint>(height, kind, product, block, {B, B + whole, 2 * whole}, i, j);
    });
    if (has_last_column<Real>(n)) form_last_entries<adjoint>(height, product, i);
  });
}

// Work of one row of the block at row i: for each vector of each tile needed, its terms in k and a
// constant for starting and storing the tile.
template <class Real>
inline Index work_in_row(const SplitProduct<Real>& product, Index i, Index height) {
  constexpr Index start_and_store = 8;  // estimated, in terms
  Index work = 0;
  for_panels<Real>(product.n, [&](TileColumns, Index j, Index columns) {
    if (unneeded(product, i, height, j, columns)) return;
    const Range of_k = nonzero_terms(product, i, height, j, columns);
    const Index vectors = (columns + width<Real> - 1) / width<Real>;
    if (of_k.begin < of_k.end) work += vectors * (of_k.end - of_k.begin + start_and_store);
  });
  return work;
}

// Returns the rows of parts first_part ... end_part - 1. The boundary between two parts does not
// depend on which parts a call forms.
template <class Real>
__attribute__((noinline)) Range rows_of_share(const SplitProduct<Real>& product) {
  const Index n = product.n;
  if (product.first_part == 0 && product.end_part == product.parts) return {0, n};
  const auto for_blocks = [n](auto&& visit) __attribute__((always_inline)) {
    for (Index i = 0; i < n; i += tile_rows) visit(i, smaller(tile_rows, n - i));
  };
  Index all = 0;
  for_blocks([&](Index i, Index height) { all += height * work_in_row(product, i, height); });
  Range rows = {0, n};
  Index above = 0;
  for_blocks([&](Index i, Index height) {
    const Index work = work_in_row(product, i, height);
    // Sets `row` to the row after the first `shares` parts if that row lies in this block.
    const auto end_of = [&](Index shares, Index & row) __attribute__((always_inline)) {
      const Index left = shares * all - product.parts * above;  // times `parts`
      if (left >= 0 && left < product.parts * height * work) {
        row = i + left / (product.parts * work);
      }
    };
    if (product.first_part > 0) end_of(product.first_part, rows.begin);
    if (product.end_part < product.parts) end_of(product.end_part, rows.end);
    above += height * work;
  });
  return rows;
}

template <bool adjoint, class Real>
void multiply_share(const SplitProduct<Real>& product) {
  const LeftFactor<Real> A = adjoint
                                 ? LeftFactor<Real>{product.A_re, product.A_im, 1, product.stride}
                                 : LeftFactor<Real>{product.A_re, product.A_im, product.stride, 1};
  const Range rows = rows_of_share(product);
  const bool last_column = has_last_column<Real>(product.n);
  if (last_column && !adjoint) pack_last_column(product);
  if (product.packs_B) {
    multiply_packed<adjoint>(product, rows, A);
  } else {
    multiply_in_place<adjoint>(product, rows, A);
  }
  if (last_column && adjoint) last_column_of_adjoint(product, rows);
}

// C = scale A B or scale A† B, in the rows of the given parts.
template <class Real>
void multiply_split(const SplitProduct<Real>& product) {
  if (product.adjoint) {
    multiply_share<true>(product);
  } else {
    multiply_share<false>(product);
  }
}

}  // namespace
}  // namespace isosyrk
