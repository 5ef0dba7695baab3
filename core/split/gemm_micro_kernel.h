// Micro-kernel: one tile of C, accumulated over k in registers.
//
// With AVX-512 in double precision a tile has 6 x 16 entries. Each entry of A meets a vector of B's
// real parts and a vector of its imaginary parts, in 4 multiply-adds.
#pragma once

#include "isosyrk/split/gemm_bands.h"

namespace isosyrk {
namespace {

// The left factor, A or A†, by the steps from row to row and from column to column.
template <class Real>
struct LeftFactor {
  const Real* re;
  const Real* im;
  Index row;
  Index column;
};

// The left factor from row i on.
template <class Real>
inline LeftFactor<Real> rows_from(const LeftFactor<Real>& A, Index i) {
  return {A.re + i * A.row, A.im + i * A.row, A.row, A.column};
}

// The columns of B that a tile takes, in B itself or packed.
template <class Real>
struct Panel {
  const Real* re;
  const Real* im;
  Index step;  // from row to row
};

// A tile of `rows` rows and `vectors` vectors, summed over of_k, scaled and stored. `rows` and
// `vectors` are constants, so that the sums stay in registers.
template <int rows, int vectors, bool adjoint, class Real>
inline __attribute__((always_inline)) void sum_tile(Range of_k, const LeftFactor<Real>& A,
                                                    const Panel<Real>& B, Real scale, Real* C_re,
                                                    Real* C_im, Index C_stride) {
  Vector<Real> re[rows][vectors] = {};
  Vector<Real> im[rows][vectors] = {};
  const RowSteps steps(A.row);
  const Index A_step = adjoint ? A.column : 1;
  const Real* A_re = A.re + of_k.begin * A_step;
  const Real* A_im = A.im + of_k.begin * A_step;
  const Real* const A_end = A.re + of_k.end * A_step;
  const Real* B_re = B.re + of_k.begin * B.step;
  Index to_im = B.im - B.re;
  keep(to_im);
  while (A_re < A_end) {
    Vector<Real> x[vectors];
    Vector<Real> y[vectors];
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      x[v] = load(B_re + v * width<Real>);
      y[v] = load(B_re + to_im + v * width<Real>);
    }
    B_re += B.step;
    keep(B_re);
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r) {
      const Real a = A_re[adjoint ? r : steps[r]];
      const Real b = A_im[adjoint ? r : steps[r]];
#pragma GCC unroll 4
      for (int v = 0; v < vectors; ++v) {
        re[r][v] += a * x[v];
        im[r][v] += a * y[v];
        if constexpr (adjoint) {
          re[r][v] += b * y[v];
          im[r][v] -= b * x[v];
        } else {
          re[r][v] -= b * y[v];
          im[r][v] += b * x[v];
        }
      }
    }
    A_re += A_step;
    A_im += A_step;
    keep(A_re);
    keep(A_im);
  }
  if (scale != 1) {  // most products have scale 1, and skip these multiplications
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r) {
#pragma GCC unroll 4
      for (int v = 0; v < vectors; ++v) {
        re[r][v] *= scale;
        im[r][v] *= scale;
      }
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < rows; ++r) {
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      store(C_re + r * C_stride + v * width<Real>, re[r][v]);
      store(C_im + r * C_stride + v * width<Real>, im[r][v]);
    }
  }
}

// A tile of whole vectors at (i, j) of C. A begins at row i, B at column j.
template <int rows, int vectors, bool adjoint, class Real>
__attribute__((noinline)) void whole_tile(const SplitProduct<Real>& product,
                                          const LeftFactor<Real>& A, const Panel<Real>& B, Index i,
                                          Index j) {
  const Index at = i * product.stride + j;
  sum_tile<rows, vectors, adjoint>(nonzero_terms(product, i, rows, j, vectors * width<Real>), A, B,
                                   product.scale, product.C_re + at, product.C_im + at,
                                   product.stride);
}

// A tile at (i, j) where fewer than `width` columns are left. It is summed in a buffer, since the
// padding of C must stay 0.
template <int rows, bool adjoint, class Real>
__attribute__((noinline)) void partial_tile(const SplitProduct<Real>& product,
                                            const LeftFactor<Real>& A, const Panel<Real>& B,
                                            Index i, Index j) {
  Real re[rows * width<Real>];
  Real im[rows * width<Real>];
  sum_tile<rows, 1, adjoint>(nonzero_terms(product, i, rows, j, product.n - j), A, B, product.scale,
                             re, im, width<Real>);
  for (int r = 0; r < rows; ++r) {
    for (Index c = j; c < product.n; ++c) {
      product.C_re[(i + r) * product.stride + c] = re[r * width<Real> + (c - j)];
      product.C_im[(i + r) * product.stride + c] = im[r * width<Real> + (c - j)];
    }
  }
}

// Columns of a tile: `tile_vectors` vectors, one vector, or a part of a vector.
enum class TileColumns { all_vectors, one_vector, part_of_vector };

template <int rows, bool adjoint, class Real>
void tile_of_height(TileColumns columns, const SplitProduct<Real>& product,
                    const LeftFactor<Real>& A, const Panel<Real>& B, Index i, Index j) {
  if (columns == TileColumns::all_vectors) {
    whole_tile<rows, tile_vectors, adjoint>(product, A, B, i, j);
  } else if (columns == TileColumns::one_vector) {
    whole_tile<rows, 1, adjoint>(product, A, B, i, j);
  } else {
    partial_tile<rows, adjoint>(product, A, B, i, j);
  }
}

// Calls form(Height<rows>()) with `rows`, 1 ... 6, as a constant.
template <int rows>
struct Height {};
template <class Form>
inline __attribute__((always_inline)) void with_height(Index rows, Form&& form) {
  switch (rows) {
    case 6:
      return form(Height<6>());
    case 5:
      return form(Height<5>());
    case 4:
      return form(Height<4>());
    case 3:
      return form(Height<3>());
    case 2:
      return form(Height<2>());
    default:
      return form(Height<1>());
  }
}

// The tile of `rows` rows, 1 ... 6, at (i, j) of C. A begins at row i, B at column j.
template <bool adjoint, class Real>
void form_tile(Index rows, TileColumns columns, const SplitProduct<Real>& product,
               const LeftFactor<Real>& A, const Panel<Real>& B, Index i, Index j) {
  with_height(rows, [&]<int height>(Height<height>) {
    tile_of_height<height, adjoint>(columns, product, A, B, i, j);
  });
}

}  // namespace
}  // namespace isosyrk
