// Macro-kernel: the loops over panels of B and blocks of rows of A.
#pragma once

#include "isosyrk/split/gemm_edge.h"

namespace isosyrk {
namespace {

// Cuts the rows first ... end - 1 into blocks of nearly equal height, `most` at most, and calls
// tiles(first row, height). A last block of few rows would have too few independent sums to hide
// the latency of a multiply-add.
template <class Tiles>
inline __attribute__((always_inline)) void for_row_blocks(Index first, Index end, Tiles&& tiles,
                                                          Index most = tile_rows) {
  const Index blocks = (end - first + most - 1) / most;
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
void multiply_in_place(const SplitProduct<Real>& product, Range rows, const LeftFactor<Real>& A,
                       const Real* last_column) {
  for_panels<Real>(product.n, [&](TileColumns kind, Index j, Index columns) {
    const Panel<Real> B{product.B_re + j, product.B_im + j, product.stride};
    const Index end = product.upper ? smaller(j + columns, rows.end) : rows.end;
    const bool column_follows = j + columns + 1 == product.n;
    for_row_blocks(rows.begin, end, [&](Index i, Index height) {
      if (!unneeded(product, i, height, j, columns)) {
        form_tile<adjoint>(height, kind, product, rows_from(A, i), B, i, j);
      }
      if (column_follows) form_last_entries<adjoint>(height, product, i, last_column);
    });
    if (!column_follows) return;
    for (Index i = greater(end, rows.begin); i < rows.end; ++i) {
      form_last_entries<adjoint>(1, product, i, last_column);
    }
  });
}

// For larger matrices. While all packed panels of B are in the second-level cache, a block of rows
// of A stays in the first-level cache and the panels stream. Where they are not, each panel serves
// several blocks: else B would be read from memory for every block, faster than many threads
// together can.
template <bool adjoint, class Real>
void multiply_packed(const SplitProduct<Real>& product, Range rows, const LeftFactor<Real>& A,
                     Real* scratch) {
  const auto form = [&](Index first, Index count) {
    const Index end = first + count;
    LeftFactor<Real> blocks[rows_together / tile_rows];
    Index b = 0;
    for_row_blocks(first, end, [&](Index i, Index height) {
      blocks[b] = rows_from(A, i);
      if (adjoint && product.packs_adjoint_A) {
        Real* const to = scratch + 3 * product.stride / 2 + 2 * b * tile_rows * product.n;
        blocks[b] = pack_adjoint_rows(product, blocks[b], i, height, to);
      }
      ++b;
    });
    for_panels<Real>(product.n, [&](TileColumns kind, Index j, Index columns) {
      const Index whole = whole_vectors<Real>(columns);
      const Real* B = packed_panel(product, j);
      b = 0;
      for_row_blocks(first, end, [&](Index i, Index height) {
        const LeftFactor<Real>& block = blocks[b++];
        if (unneeded(product, i, height, j, columns)) return;
        form_tile<adjoint>(height, kind, product, block, {B, B + whole, 2 * whole}, i, j);
      });
    });
    if (!has_last_column<Real>(product.n)) return;
    for_row_blocks(first, end, [&](Index i, Index height) {
      form_last_entries<adjoint>(height, product, i, scratch);
    });
  };
  for_row_blocks(rows.begin, rows.end, form, product.is_B_near ? tile_rows : rows_together);
}

template <bool adjoint, class Real>
void multiply(const SplitProduct<Real>& product, Range rows, Real* scratch) {
  const LeftFactor<Real> A = adjoint
                                 ? LeftFactor<Real>{product.A_re, product.A_im, 1, product.stride}
                                 : LeftFactor<Real>{product.A_re, product.A_im, product.stride, 1};
  const bool last_column = has_last_column<Real>(product.n);
  if (last_column && !adjoint) pack_last_column(product, scratch);
  if (product.packed_B != nullptr) {
    multiply_packed<adjoint>(product, rows, A, scratch);
  } else {
    multiply_in_place<adjoint>(product, rows, A, scratch);
  }
  if (last_column && adjoint) last_column_of_adjoint(product, rows, scratch);
}

// C = scale A B or scale A† B, in the given rows.
template <class Real>
void form_rows(const SplitProduct<Real>& product, Index first, Index end, Real* scratch) {
  if (product.adjoint) {
    multiply<true>(product, Range{first, end}, scratch);
  } else {
    multiply<false>(product, Range{first, end}, scratch);
  }
}

template <class Real>
void pack_columns(const SplitProduct<Real>& product, Index first, Index end) {
  for_panels<Real>(product.n, [&](TileColumns, Index j, Index columns) {
    if (first <= j && j < end) pack_panel(product, j, columns);
  });
}

}  // namespace
}  // namespace isosyrk
