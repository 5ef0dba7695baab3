// Products of planar matrices by tiles that stay in registers.  For the files planar_kernel_*.cpp
// only, each compiled for one vector unit, which first say what that holds: `width` doubles in a
// vector, and a tile of `tile_rows` rows by `tile_vectors` vectors.
//
// Everything here is local to such a file and calls nothing: a function that the linker could take
// from another of them might run where its unit does not exist.
//
// A tile of C is summed over k in registers, real and imaginary parts together: 4 multiply-adds for
// an entry of A against a vector of B's real and a vector of its imaginary parts.
#pragma once

namespace isosyrk {
namespace {

using Index = std::ptrdiff_t;

typedef double Vector __attribute__((vector_size(8 * width), aligned(8), may_alias));

inline Vector load(const double* at) { return *reinterpret_cast<const Vector*>(at); }
inline void store(double* at, Vector value) { *reinterpret_cast<Vector*>(at) = value; }

// A or A†, by the steps from row to row and from column to column.
struct Left {
  const double* re;
  const double* im;
  Index row;
  Index column;
};

template <int rows, int vectors, bool adjoint>
inline __attribute__((always_inline)) void sum_tile(Index n, const Left& A, const double* B_re,
                                                    const double* B_im, Index B_step, double scale,
                                                    double* C_re, double* C_im, Index C_stride) {
  Vector re[rows][vectors] = {};
  Vector im[rows][vectors] = {};
  for (Index k = 0; k < n; ++k) {
    Vector x[vectors];
    Vector y[vectors];
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      x[v] = load(B_re + k * B_step + v * width);
      y[v] = load(B_im + k * B_step + v * width);
    }
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r) {
      const double a = A.re[r * A.row + k * A.column];
      const double b = A.im[r * A.row + k * A.column];
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
  }
#pragma GCC unroll 8
  for (int r = 0; r < rows; ++r) {
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      store(C_re + r * C_stride + v * width, scale * re[r][v]);
      store(C_im + r * C_stride + v * width, scale * im[r][v]);
    }
  }
}

inline Left rows_from(const Left& A, Index i) {
  return {A.re + i * A.row, A.im + i * A.row, A.row, A.column};
}

// The columns of B that a tile takes: of B itself, or a copy in which they follow one another.
struct Panel {
  const double* re;
  const double* im;
  Index step;  // from row to row
};

// The tile of C that begins at (i, j), from those rows of A.
template <int rows, int vectors, bool adjoint>
__attribute__((noinline)) void whole_tile(const PlanarProduct& product, const Left& A,
                                          const Panel& B, Index i, Index j) {
  const Index at = i * product.stride + j;
  sum_tile<rows, vectors, adjoint>(product.n, A, B.re, B.im, B.step, product.scale,
                                   product.C_re + at, product.C_im + at, product.stride);
}

// The same where fewer than `width` columns are left: summed aside, since what fills up the rows of
// C must stay 0.
template <int rows, bool adjoint>
__attribute__((noinline)) void partial_tile(const PlanarProduct& product, const Left& A,
                                            const Panel& B, Index i, Index j) {
  double re[rows * width];
  double im[rows * width];
  sum_tile<rows, 1, adjoint>(product.n, A, B.re, B.im, B.step, product.scale, re, im, width);
  for (int r = 0; r < rows; ++r) {
    for (Index c = j; c < product.n; ++c) {
      product.C_re[(i + r) * product.stride + c] = re[r * width + (c - j)];
      product.C_im[(i + r) * product.stride + c] = im[r * width + (c - j)];
    }
  }
}

enum class Kind { whole, single, partial };

template <int rows, bool adjoint>
void one_tile(Kind kind, const PlanarProduct& product, const Left& A, const Panel& B, Index i,
              Index j) {
  if (kind == Kind::whole) {
    whole_tile<rows, tile_vectors, adjoint>(product, A, B, i, j);
  } else if (kind == Kind::single) {
    whole_tile<rows, 1, adjoint>(product, A, B, i, j);
  } else {
    partial_tile<rows, adjoint>(product, A, B, i, j);
  }
}

template <bool adjoint>
void one_tile(Index rows, Kind kind, const PlanarProduct& product, const Left& A, const Panel& B,
              Index i, Index j) {
  switch (rows) {
    case 6:
      one_tile<6, adjoint>(kind, product, A, B, i, j);
      break;
    case 5:
      one_tile<5, adjoint>(kind, product, A, B, i, j);
      break;
    case 4:
      one_tile<4, adjoint>(kind, product, A, B, i, j);
      break;
    case 3:
      one_tile<3, adjoint>(kind, product, A, B, i, j);
      break;
    case 2:
      one_tile<2, adjoint>(kind, product, A, B, i, j);
      break;
    default:
      one_tile<1, adjoint>(kind, product, A, B, i, j);
      break;
  }
}

// Rows first ... end - 1 in blocks of nearly equal height: a low one at the end would leave the
// multiply-adds waiting for one another.  Calls tiles(first row, height).
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

// Calls panel(kind, first column, columns) for all columns, but for a single one that is left.
template <class Visit>
inline __attribute__((always_inline)) void for_panels(Index n, Visit&& panel) {
  constexpr Index columns = tile_vectors * width;
  Index j = 0;
  for (; j + columns <= n; j += columns) panel(Kind::whole, j, columns);
  for (; j + width <= n; j += width) panel(Kind::single, j, Index{width});
  if (j + 1 < n) panel(Kind::partial, j, n - j);
}

// Small matrices, which the first cache holds: columns of B as they stand.
template <bool adjoint>
void multiply_in_place(const PlanarProduct& product, const Left& A) {
  for_panels(product.n, [&](Kind kind, Index j, Index columns) {
    const Panel B{product.B_re + j, product.B_im + j, product.stride};
    const bool cut = product.upper && j + columns < product.end_row;
    const Index end = cut ? j + columns : product.end_row;
    for_row_blocks(product.first_row, end, [&](Index i, Index height) {
      one_tile<adjoint>(height, kind, product, rows_from(A, i), B, i, j);
    });
  });
}

// Larger ones: a block of rows of A stays in the first cache while panels of B, copied together,
// pass by from the second.
template <bool adjoint>
void multiply_packed(const PlanarProduct& product, const Left& A) {
  const Index n = product.n;
  const Index stride = product.stride;
  double* packed = product.scratch + 2 * stride;
  for_panels(n, [&](Kind, Index j, Index columns) {
    const Index vectors = (columns + width - 1) / width;
    double* to = packed + 2 * j * n;
    for (Index k = 0; k < n; ++k) {
      for (Index v = 0; v < vectors; ++v) {
        store(to + v * width, load(product.B_re + k * stride + j + v * width));
        store(to + (vectors + v) * width, load(product.B_im + k * stride + j + v * width));
      }
      to += 2 * vectors * width;
    }
  });
  double* columns_of_A = packed + 2 * n * stride;
  for_row_blocks(product.first_row, product.end_row, [&](Index i, Index height) {
    Left block = rows_from(A, i);
    if (adjoint) {  // columns of A, which lie far apart
      for (Index k = 0; k < n; ++k) {
        for (Index r = 0; r < height; ++r) {
          columns_of_A[2 * tile_rows * k + r] = block.re[k * A.column + r];
          columns_of_A[2 * tile_rows * k + tile_rows + r] = block.im[k * A.column + r];
        }
      }
      block = {columns_of_A, columns_of_A + tile_rows, 1, 2 * tile_rows};
    }
    for_panels(n, [&](Kind kind, Index j, Index columns) {
      if (product.upper && j + columns <= i) return;
      const Index whole = (columns + width - 1) / width * width;
      const double* B = packed + 2 * j * n;
      one_tile<adjoint>(height, kind, product, block, {B, B + whole, 2 * whole}, i, j);
    });
  });
}

// Entries i ... i + rows - 1 of A (x + iy), into the last column of C.
template <int rows>
inline __attribute__((always_inline)) void last_entries(const PlanarProduct& product,
                                                        const double* x, const double* y, Index i) {
  const Index stride = product.stride;
  const double* A_re = product.A_re + i * stride;
  const double* A_im = product.A_im + i * stride;
  Vector re[rows] = {};
  Vector im[rows] = {};
  for (Index k = 0; k < product.n; k += width) {
    const Vector xs = load(x + k);
    const Vector ys = load(y + k);
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r) {
      const Vector a = load(A_re + r * stride + k);
      const Vector b = load(A_im + r * stride + k);
      re[r] += a * xs;
      im[r] += a * ys;
      re[r] -= b * ys;
      im[r] += b * xs;
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < rows; ++r) {
    double sum_re = 0.0;
    double sum_im = 0.0;
    for (int v = 0; v < width; ++v) {
      sum_re += re[r][v];
      sum_im += im[r][v];
    }
    const Index at = (i + r) * stride + product.n - 1;
    product.C_re[at] = product.scale * sum_re;
    product.C_im[at] = product.scale * sum_im;
  }
}

// A single column that is left, as all n = 16 k + 1 have: a matrix times a vector, by rows of A.
inline void last_column(const PlanarProduct& product) {
  const Index n = product.n;
  const Index stride = product.stride;
  double* x = product.scratch;  // the column of B, filled up with 0
  double* y = product.scratch + stride;
  for (Index k = 0; k < n; ++k) {
    x[k] = product.B_re[k * stride + n - 1];
    y[k] = product.B_im[k * stride + n - 1];
  }
  for (Index k = n; k < stride; ++k) x[k] = y[k] = 0.0;
  constexpr Index together = 4;
  Index i = product.first_row;
  for (; i + together <= product.end_row; i += together) last_entries<together>(product, x, y, i);
  for (; i < product.end_row; ++i) last_entries<1>(product, x, y, i);
}

// The same of A†: by columns of A, which are rows of what is summed.
inline void last_column_of_adjoint(const PlanarProduct& product) {
  const Index n = product.n;
  const Index stride = product.stride;
  double* re = product.scratch;
  double* im = product.scratch + stride;
  constexpr int vectors = 8 / width;  // a row is filled up to whole blocks of 8
  for (Index i = product.first_row / 8 * 8; i < product.end_row; i += 8) {
    Vector ax[vectors] = {}, by[vectors] = {}, ay[vectors] = {}, bx[vectors] = {};
    for (Index k = 0; k < n; ++k) {
      const double x = product.B_re[k * stride + n - 1];
      const double y = product.B_im[k * stride + n - 1];
#pragma GCC unroll 4
      for (int v = 0; v < vectors; ++v) {
        const Vector a = load(product.A_re + k * stride + i + v * width);
        const Vector b = load(product.A_im + k * stride + i + v * width);
        ax[v] += a * x;
        by[v] += b * y;
        ay[v] += a * y;
        bx[v] += b * x;
      }
    }
#pragma GCC unroll 4
    for (int v = 0; v < vectors; ++v) {
      store(re + i + v * width, product.scale * (ax[v] + by[v]));
      store(im + i + v * width, product.scale * (ay[v] - bx[v]));
    }
  }
  for (Index i = product.first_row; i < product.end_row; ++i) {
    product.C_re[i * stride + n - 1] = re[i];
    product.C_im[i * stride + n - 1] = im[i];
  }
}

template <bool adjoint>
void multiply_tiles(const PlanarProduct& product) {
  const Left A = adjoint ? Left{product.A_re, product.A_im, 1, product.stride}
                         : Left{product.A_re, product.A_im, product.stride, 1};
  if (product.n > planar_largest_in_place) {
    multiply_packed<adjoint>(product, A);
  } else {
    multiply_in_place<adjoint>(product, A);
  }
  if (product.n % width != 1) return;
  if (adjoint) {
    last_column_of_adjoint(product);
  } else {
    last_column(product);
  }
}

void multiply_planar(const PlanarProduct& product) {
  if (product.adjoint) {
    multiply_tiles<true>(product);
  } else {
    multiply_tiles<false>(product);
  }
}

}  // namespace
}  // namespace isosyrk
