// Vectors of a few real numbers and square blocks of them, for transposes and for loops along
// diagonals.
#pragma once

#include <cstdint>
#include <type_traits>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// The numbers in one vector of 32 bytes: 4 in double, 8 in single precision.
template <class Real>
inline constexpr int lanes = 32 / sizeof(Real);

/// Consecutive real numbers, as many as `lanes`.
template <class Real>
struct VectorOf {
  typedef Real type __attribute__((vector_size(32)));
  using Integer = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Integer Bits __attribute__((vector_size(32)));
};
template <class Real>
using Lanes = typename VectorOf<Real>::type;

// `at` need not be aligned.  Copied by memcpy, since clang assumes that a reference to a vector is
// aligned, whatever the alignment of the vector type.
template <class Real>
inline __attribute__((always_inline)) Lanes<Real> load_lanes(const Real* at) {
  Lanes<Real> values;
  __builtin_memcpy(&values, at, sizeof values);
  return values;
}
template <class Real>
inline __attribute__((always_inline)) void store_lanes(Real* at, const Lanes<Real>& values) {
  __builtin_memcpy(at, &values, sizeof values);
}

/// Sets all but the first `count` numbers to 0, even if they are NaN.
template <class Real>
void clear_from(Index count, Lanes<Real>& values) {
  using Integer = typename VectorOf<Real>::Integer;
  using Bits = typename VectorOf<Real>::Bits;
  Bits places;
  for (int i = 0; i < lanes<Real>; ++i) places[i] = i;
  const Bits kept = places < static_cast<Integer>(count);
  values = reinterpret_cast<Lanes<Real>>(reinterpret_cast<Bits>(values) & kept);
}

/// A square block of rows of `lanes` numbers, `stride` apart in memory.
template <class Real>
struct Block {
  static constexpr int size = lanes<Real>;
  Lanes<Real> row[size];

  void load(const Real* at, Index stride) {
    for (Index r = 0; r < size; ++r) row[r] = load_lanes(at + r * stride);
  }
  void store(Real* at, Index stride) const {
    for (Index r = 0; r < size; ++r) store_lanes(at + r * stride, row[r]);
  }
  // Exchanges the off-diagonal entries of all 2 x 2 blocks, then those of blocks of blocks.
  void transpose() {
    if constexpr (size == 4) {
      for (const int r : {0, 2}) {
        const Lanes<Real> even = row[r], odd = row[r + 1];
        row[r] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
        row[r + 1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
      }
      for (const int r : {0, 1}) {
        const Lanes<Real> upper = row[r], lower = row[r + 2];
        row[r] = __builtin_shufflevector(upper, lower, 0, 1, 4, 5);
        row[r + 2] = __builtin_shufflevector(upper, lower, 2, 3, 6, 7);
      }
    } else {
      for (const int r : {0, 2, 4, 6}) {
        const Lanes<Real> even = row[r], odd = row[r + 1];
        row[r] = __builtin_shufflevector(even, odd, 0, 8, 2, 10, 4, 12, 6, 14);
        row[r + 1] = __builtin_shufflevector(even, odd, 1, 9, 3, 11, 5, 13, 7, 15);
      }
      for (const int r : {0, 1, 4, 5}) {
        const Lanes<Real> upper = row[r], lower = row[r + 2];
        row[r] = __builtin_shufflevector(upper, lower, 0, 1, 8, 9, 4, 5, 12, 13);
        row[r + 2] = __builtin_shufflevector(upper, lower, 2, 3, 10, 11, 6, 7, 14, 15);
      }
      for (const int r : {0, 1, 2, 3}) {
        const Lanes<Real> upper = row[r], lower = row[r + 4];
        row[r] = __builtin_shufflevector(upper, lower, 0, 1, 2, 3, 8, 9, 10, 11);
        row[r + 4] = __builtin_shufflevector(upper, lower, 4, 5, 6, 7, 12, 13, 14, 15);
      }
    }
  }
};

}  // namespace isosyrk
