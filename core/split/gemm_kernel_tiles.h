// Products of planar matrices by tiles that stay in registers.  For the files gemm_kernel_*.cpp
// only, each compiled for one vector unit, which first say what that holds: vectors of
// `vector_bytes`, a tile of `tile_rows` rows (6 at most) by `tile_vectors` vectors, and
// half_twice(at), a vector both halves of which hold the numbers from `at` on.  Real is double or
// float.
//
// Everything here is local to such a file and calls nothing: a function that the linker could take
// from another of them might run where its unit does not exist.
//
// A tile of C is summed over k in registers, real and imaginary parts together: 4 multiply-adds for
// an entry of A against a vector of B's real and a vector of its imaginary parts.  (Three, from the
// sums of real and imaginary parts, take a quarter longer with AVX-512, n = 33 ... 129: their loads
// bound them, and the sums have to be formed.)
#pragma once

namespace isosyrk {
namespace {

using Index = std::ptrdiff_t;

template <class Real>
struct VectorOf {
  typedef Real type __attribute__((vector_size(vector_bytes), aligned(alignof(Real)), may_alias));
};
template <class Real>
using Vector = typename VectorOf<Real>::type;

template <class Real>
constexpr int width = vector_bytes / sizeof(Real);

template <class Real>
inline Vector<Real> load(const Real* at) {
  return *reinterpret_cast<const Vector<Real>*>(at);
}
template <class Real>
inline void store(Real* at, Vector<Real> value) {
  *reinterpret_cast<Vector<Real>*>(at) = value;
}

// Indices begin ... end - 1.
struct Range {
  Index begin;
  Index end;
};

constexpr Index smaller(Index a, Index b) { return a < b ? a : b; }
constexpr Index larger(Index a, Index b) { return a < b ? b : a; }

// What k reaches within `band` of the indices first ... end - 1.
constexpr Range near(Index n, Index first, Index end, Index band) {
  return {larger(0, first - band), smaller(n, end + band)};
}

// Where neither A's rows first_row ... nor B's columns first_column ... are 0.
template <class Real>
inline Range factors_meet(const SplitProduct<Real>& product, Index first_row, Index rows,
                          Index first_column, Index columns) {
  const Range of_A = near(product.n, first_row, first_row + rows, product.A_band);
  const Range of_B = near(product.n, first_column, first_column + columns, product.B_band);
  return {larger(of_A.begin, of_B.begin), smaller(of_A.end, of_B.end)};
}

// Whether nothing is wanted of those columns in the rows from `row` on.
template <class Real>
inline bool unwanted(const SplitProduct<Real>& product, Index row, Index rows, Index column,
                     Index columns) {
  return column >= row + rows + product.C_band || column + columns <= row - product.C_band ||
         (product.upper && column + columns <= row);
}

// A or A†, by the steps from row to row and from column to column.
template <class Real>
struct Left {
  const Real* re;
  const Real* im;
  Index row;
  Index column;
};

// Says of a number, as the compiler sees it, only that a register holds it.
template <class T>
inline __attribute__((always_inline)) void keep(T& number) {
  asm("" : "+r"(number));
}

// How far rows 0 ... 5 lie from the first, by three registers and what an address multiplies by
// itself.  Left alone, the compiler keeps a pointer to each row, of real and of imaginary parts,
// and fetches those that find no register in the innermost loop.
struct RowSteps {
  explicit RowSteps(Index row) : one(row), three(3 * row), five(5 * row) {
    keep(three);
    keep(five);
  }

  inline __attribute__((always_inline)) Index operator[](int r) const {
    return r == 3 ? three : r == 5 ? five : r * one;
  }

  Index one;
  Index three;
  Index five;
};

// The columns of B that a tile takes: of B itself, or a copy in which they follow one another.
template <class Real>
struct Panel {
  const Real* re;
  const Real* im;
  Index step;  // from row to row
};

template <int rows, int vectors, bool adjoint, class Real>
inline __attribute__((always_inline)) void sum_tile(Range of_k, const Left<Real>& A,
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
  // Not unrolled: turns of 2 to 4 k were no faster.
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
  if (scale != 1) {  // not multiplying by 1: 2 to 3 % with vectors of 64 bytes
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

template <class Real>
inline Left<Real> rows_from(const Left<Real>& A, Index i) {
  return {A.re + i * A.row, A.im + i * A.row, A.row, A.column};
}

// The tile of C that begins at (i, j), from those rows of A.
template <int rows, int vectors, bool adjoint, class Real>
__attribute__((noinline)) void whole_tile(const SplitProduct<Real>& product, const Left<Real>& A,
                                          const Panel<Real>& B, Index i, Index j) {
  const Index at = i * product.stride + j;
  sum_tile<rows, vectors, adjoint>(factors_meet(product, i, rows, j, vectors * width<Real>), A, B,
                                   product.scale, product.C_re + at, product.C_im + at,
                                   product.stride);
}

// The same where fewer than `width` columns are left: summed aside, since what fills up the rows of
// C must stay 0.
template <int rows, bool adjoint, class Real>
__attribute__((noinline)) void partial_tile(const SplitProduct<Real>& product, const Left<Real>& A,
                                            const Panel<Real>& B, Index i, Index j) {
  Real re[rows * width<Real>];
  Real im[rows * width<Real>];
  sum_tile<rows, 1, adjoint>(factors_meet(product, i, rows, j, product.n - j), A, B, product.scale,
                             re, im, width<Real>);
  for (int r = 0; r < rows; ++r) {
    for (Index c = j; c < product.n; ++c) {
      product.C_re[(i + r) * product.stride + c] = re[r * width<Real> + (c - j)];
      product.C_im[(i + r) * product.stride + c] = im[r * width<Real> + (c - j)];
    }
  }
}

enum class Kind { whole, single, partial };

template <int rows, bool adjoint, class Real>
void one_tile(Kind kind, const SplitProduct<Real>& product, const Left<Real>& A,
              const Panel<Real>& B, Index i, Index j) {
  if (kind == Kind::whole) {
    whole_tile<rows, tile_vectors, adjoint>(product, A, B, i, j);
  } else if (kind == Kind::single) {
    whole_tile<rows, 1, adjoint>(product, A, B, i, j);
  } else {
    partial_tile<rows, adjoint>(product, A, B, i, j);
  }
}

// Whether a single column is left by whole vectors, as by all n = 16 k + 1: apart from the tiles, a
// matrix times a vector.
template <class Real>
inline bool has_last_column(Index n) {
  return n > 1 && n % Index{width<Real>} == 1;
}

// The rows of B's last column x + iy that are not 0, from a multiple of half a vector's width on.
template <class Real>
inline Range rows_of_last_column(const SplitProduct<Real>& product) {
  constexpr Index half = width<Real> / 2;
  const Range of_k = near(product.n, product.n - 1, product.n, product.B_band);
  return {of_k.begin / half * half, of_k.end};
}

// For last_entries: as many of -y, of x and of y as half a vector holds after one another, filled
// up with 0.  Number by number, and so before the tiles are formed: vectors of it can be read by
// then.
template <class Real>
inline void copy_last_column(const SplitProduct<Real>& product) {
  constexpr Index half = width<Real> / 2;
  const Range of_k = rows_of_last_column(product);
  const Real* x = product.B_re + of_k.begin * product.stride + product.n - 1;
  const Real* y = product.B_im + of_k.begin * product.stride + product.n - 1;
  Real* to = product.scratch + 3 * of_k.begin;
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

// Lane l: the sum of lanes l and l ^ distance, of `a` where that bit of l is 0, of `b` where it
// is 1.
template <class Real, int distance, int... lanes>
inline __attribute__((always_inline)) Vector<Real> sums_of_pairs(Vector<Real> a, Vector<Real> b,
                                                                 Lanes<lanes...>) {
  return __builtin_shufflevector(
             a, b, ((lanes & distance) != 0 ? (lanes ^ distance) + width<Real> : lanes)...) +
         __builtin_shufflevector(
             a, b, ((lanes & distance) != 0 ? lanes + width<Real> : (lanes ^ distance))...);
}

// In each half, lane l: the sum over that half's lanes of vector l modulo `count`, a power of two
// up to half the width.
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

// Entries i, i + 1 ... of C's last column from what is still to be summed over a vector's halves,
// real parts over the first and imaginary ones over the second: so many together as find room.
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

// Entries i ... i + rows - 1 of A (x + iy), by rows of A: of one, a real part times [x, y] and an
// imaginary part times [-y, x], half a vector of either at a time.
template <int rows, class Real>
__attribute__((noinline)) void last_entries(const SplitProduct<Real>& product, Index i) {
  constexpr Index half = width<Real> / 2;
  const RowSteps steps(product.stride);
  const Range of_A = near(product.n, i, i + rows, product.A_band);
  const Range of_B = rows_of_last_column(product);
  const Index begin = larger(of_A.begin / half * half, of_B.begin);
  const Index end = smaller(of_A.end, of_B.end);
  const Real* A_re = product.A_re + i * product.stride + begin;
  const Real* A_im = product.A_im + i * product.stride + begin;
  const Real* column = product.scratch + 3 * begin;
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

// Calls form(Rows<height>()) for a height known only here, 1 ... 6.
template <int rows>
struct Rows {};
template <class Form>
inline __attribute__((always_inline)) void with_rows(Index rows, Form&& form) {
  switch (rows) {
    case 6:
      return form(Rows<6>());
    case 5:
      return form(Rows<5>());
    case 4:
      return form(Rows<4>());
    case 3:
      return form(Rows<3>());
    case 2:
      return form(Rows<2>());
    default:
      return form(Rows<1>());
  }
}

template <bool adjoint, class Real>
void one_tile(Index rows, Kind kind, const SplitProduct<Real>& product, const Left<Real>& A,
              const Panel<Real>& B, Index i, Index j) {
  with_rows(rows, [&]<int height>(Rows<height>) {
    one_tile<height, adjoint>(kind, product, A, B, i, j);
  });
}

// Where it is wanted, and formed by rows: not of A†.
template <bool adjoint, class Real>
void last_entries(Index rows, const SplitProduct<Real>& product, Index i) {
  if (adjoint || unwanted(product, i, rows, product.n - 1, 1)) return;
  with_rows(rows, [&]<int height>(Rows<height>) { last_entries<height>(product, i); });
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

// Calls panel(kind, first column, columns) for all columns but a last one by itself.
template <class Real, class Visit>
inline __attribute__((always_inline)) void for_panels(Index n, Visit&& panel) {
  constexpr Index columns = tile_vectors * width<Real>;
  Index j = 0;
  for (; j + columns <= n; j += columns) panel(Kind::whole, j, columns);
  for (; j + width<Real> <= n; j += width<Real>) panel(Kind::single, j, Index{width<Real>});
  if (j < n && !has_last_column<Real>(n)) panel(Kind::partial, j, n - j);
}

// Small matrices, which the caches hold: columns of B as they stand.  A last column by itself is
// formed between the tiles next to it, whose sums it needs not wait for.
template <bool adjoint, class Real>
void multiply_in_place(const SplitProduct<Real>& product, Range rows, const Left<Real>& A) {
  for_panels<Real>(product.n, [&](Kind kind, Index j, Index columns) {
    const Panel<Real> B{product.B_re + j, product.B_im + j, product.stride};
    const Index end = product.upper ? smaller(j + columns, rows.end) : rows.end;
    const bool column_follows = j + columns + 1 == product.n;
    for_row_blocks(rows.begin, end, [&](Index i, Index height) {
      if (!unwanted(product, i, height, j, columns)) {
        one_tile<adjoint>(height, kind, product, rows_from(A, i), B, i, j);
      }
      if (column_follows) last_entries<adjoint>(height, product, i);
    });
    if (!column_follows) return;
    for (Index i = larger(end, rows.begin); i < rows.end; ++i) {
      last_entries<adjoint>(1, product, i);
    }
  });
}

// Larger ones: a block of rows of A stays in the first cache while panels of B, copied together,
// pass by from the second.
template <bool adjoint, class Real>
void multiply_packed(const SplitProduct<Real>& product, Range rows, const Left<Real>& A) {
  const Index n = product.n;
  const Index stride = product.stride;
  Real* packed = product.scratch + gemm_scratch(n, stride, false);
  for_panels<Real>(n, [&](Kind, Index j, Index columns) {
    const Index vectors = (columns + width<Real> - 1) / width<Real>;
    const Range of_k = near(n, j, j + columns, product.B_band);
    Real* to = packed + 2 * j * n + 2 * vectors * width<Real> * of_k.begin;
    for (Index k = of_k.begin; k < of_k.end; ++k) {
      for (Index v = 0; v < vectors; ++v) {
        store(to + v * width<Real>, load(product.B_re + k * stride + j + v * width<Real>));
        store(to + (vectors + v) * width<Real>,
              load(product.B_im + k * stride + j + v * width<Real>));
      }
      to += 2 * vectors * width<Real>;
    }
  });
  Real* columns_of_A = packed + n * stride;
  for_row_blocks(rows.begin, rows.end, [&](Index i, Index height) {
    Left<Real> block = rows_from(A, i);
    if (adjoint && product.copies_adjoint_A) {  // columns of A, which lie far apart
      const Range of_k = near(n, i, i + height, product.A_band);
      for (Index k = of_k.begin; k < of_k.end; ++k) {
        for (Index r = 0; r < height; ++r) {
          columns_of_A[2 * tile_rows * k + r] = block.re[k * A.column + r];
          columns_of_A[2 * tile_rows * k + tile_rows + r] = block.im[k * A.column + r];
        }
      }
      block = {columns_of_A, columns_of_A + tile_rows, 1, 2 * tile_rows};
    }
    for_panels<Real>(n, [&](Kind kind, Index j, Index columns) {
      if (unwanted(product, i, height, j, columns)) return;
      const Index whole = (columns + width<Real> - 1) / width<Real> * width<Real>;
      const Real* B = packed + 2 * j * n;
      one_tile<adjoint>(height, kind, product, block, {B, B + whole, 2 * whole}, i, j);
    });
    if (has_last_column<Real>(n)) last_entries<adjoint>(height, product, i);
  });
}

// Entries i ... of A† (x + iy), so many vectors of them, into re and im.
template <int vectors, class Real>
inline __attribute__((always_inline)) void last_entries_of_adjoint(
    const SplitProduct<Real>& product, Index i, Real* re, Real* im) {
  const Index n = product.n;
  const Index stride = product.stride;
  Vector<Real> ax[vectors] = {}, by[vectors] = {}, ay[vectors] = {}, bx[vectors] = {};
  const Range of_k = factors_meet(product, i, vectors * width<Real>, n - 1, 1);
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

// The same of A†: by columns of A, which are rows of what is summed, where it is wanted.
template <class Real>
inline void last_column_of_adjoint(const SplitProduct<Real>& product, Range rows) {
  const Index first = larger(rows.begin, product.n - 1 - product.C_band);
  const Index end = rows.end;
  Real* re = product.scratch;
  Real* im = product.scratch + product.stride / 2;
  // Whole vectors; a row of A is filled up to them.
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

// What a block of rows takes for each row: of every tile that is wanted, the k that it is summed
// over and about as many more as to begin and to store it take, for each of its vectors.
template <class Real>
inline Index work_in_row(const SplitProduct<Real>& product, Index i, Index height) {
  constexpr Index to_begin_and_store = 8;
  Index work = 0;
  for_panels<Real>(product.n, [&](Kind, Index j, Index columns) {
    if (unwanted(product, i, height, j, columns)) return;
    const Range of_k = factors_meet(product, i, height, j, columns);
    const Index vectors = (columns + width<Real> - 1) / width<Real>;
    if (of_k.begin < of_k.end) work += vectors * (of_k.end - of_k.begin + to_begin_and_store);
  });
  return work;
}

// The rows of the share that is to be formed.
template <class Real>
__attribute__((noinline)) Range rows_of_share(const SplitProduct<Real>& product) {
  const Index n = product.n;
  if (product.parts == 1) return {0, n};
  const auto for_blocks = [n](auto&& visit) __attribute__((always_inline)) {
    for (Index i = 0; i < n; i += tile_rows) visit(i, smaller(tile_rows, n - i));
  };
  Index all = 0;
  for_blocks([&](Index i, Index height) { all += height * work_in_row(product, i, height); });
  Range rows = {0, n};
  Index above = 0;
  for_blocks([&](Index i, Index height) {
    const Index work = work_in_row(product, i, height);
    // Where the work of the shares before this one ends, and where its own does.
    const auto end_of = [&](Index shares, Index & row) __attribute__((always_inline)) {
      const Index left = shares * all - product.parts * above;  // times `parts`
      if (left >= 0 && left < product.parts * height * work) {
        row = i + left / (product.parts * work);
      }
    };
    if (product.part > 0) end_of(product.part, rows.begin);
    if (product.part + 1 < product.parts) end_of(product.part + 1, rows.end);
    above += height * work;
  });
  return rows;
}

template <bool adjoint, class Real>
void multiply_tiles(const SplitProduct<Real>& product) {
  const Left<Real> A = adjoint ? Left<Real>{product.A_re, product.A_im, 1, product.stride}
                               : Left<Real>{product.A_re, product.A_im, product.stride, 1};
  const Range rows = rows_of_share(product);
  const bool last_column = has_last_column<Real>(product.n);
  if (last_column && !adjoint) copy_last_column(product);
  if (product.copies_B) {
    multiply_packed<adjoint>(product, rows, A);
  } else {
    multiply_in_place<adjoint>(product, rows, A);
  }
  if (last_column && adjoint) last_column_of_adjoint(product, rows);
}

template <class Real>
void multiply_split(const SplitProduct<Real>& product) {
  if (product.adjoint) {
    multiply_tiles<true>(product);
  } else {
    multiply_tiles<false>(product);
  }
}

}  // namespace
}  // namespace isosyrk
