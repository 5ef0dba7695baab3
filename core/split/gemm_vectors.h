// SIMD vectors of the GEMM kernels: types, loads and stores, addressing of six rows.
//
// The headers gemm_vectors.h, gemm_bands.h, gemm_micro_kernel.h, gemm_packing.h, gemm_edge.h and
// gemm_macro_kernel.h belong to the files gemm_kernel_*.cpp only. Each of those is compiled for one
// vector unit and defines, before it includes them:
//
//   vector_bytes    size of a vector;
//   tile_rows       rows of a tile, 6 at most;
//   tile_vectors    vectors in a row of a tile;
//   half_twice(p)   the vector whose two halves both hold the numbers from p on.
//
// All of it stands in an anonymous namespace and calls no function outside. The linker could
// otherwise merge functions compiled for different vector units. Real is double or float.
#pragma once

#include <cstddef>

namespace isosyrk {
namespace {

using Index = std::ptrdiff_t;

template <class Real>
struct VectorOf {
  typedef Real type __attribute__((vector_size(vector_bytes)));
};
template <class Real>
using Vector = typename VectorOf<Real>::type;

// Numbers in a vector.
template <class Real>
constexpr int width = vector_bytes / sizeof(Real);

// `at` need not be aligned. Copied by memcpy, since clang assumes that a reference to a vector is
// aligned, whatever the alignment of the vector type.
template <class Real>
inline __attribute__((always_inline)) Vector<Real> load(const Real* at) {
  Vector<Real> values;
  __builtin_memcpy(&values, at, sizeof values);
  return values;
}
template <class Real>
inline __attribute__((always_inline)) void store(Real* at, Vector<Real> value) {
  __builtin_memcpy(at, &value, sizeof value);
}

// Optimisation barrier: keeps `number` in a register so that GCC does not rematerialise it.
template <class T>
inline __attribute__((always_inline)) void keep(T& number) {
  asm("" : "+r"(number));
}

// Offsets of rows 0 ... 5 from row 0. Three registers and the address scale factors 1, 2, 4 give
// all six. Without the barriers GCC keeps one pointer a row, for real and for imaginary parts, and
// reloads the spilled ones in the innermost loop.
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

}  // namespace
}  // namespace isosyrk
