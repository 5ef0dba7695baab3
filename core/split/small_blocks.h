// Vectors of 4 and blocks of 4 x 4 real numbers, for transposes and for loops along diagonals.
#pragma once

#include <cstdint>
#include <type_traits>

#include "isosyrk/linalg/matrix.h"

namespace isosyrk {

/// Four consecutive real numbers, in the vectors that the compiler chooses.
template <class Real>
struct FourOf {
  typedef Real type __attribute__((vector_size(4 * sizeof(Real))));
  using Integer = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Integer Bits __attribute__((vector_size(4 * sizeof(Real))));
};
template <class Real>
using Four = typename FourOf<Real>::type;

// `at` need not be aligned.  Copied by memcpy, since clang assumes that a reference to a vector is
// aligned, whatever the alignment of the vector type.
template <class Real>
inline __attribute__((always_inline)) Four<Real> load_four(const Real* at) {
  Four<Real> values;
  __builtin_memcpy(&values, at, sizeof values);
  return values;
}
template <class Real>
inline __attribute__((always_inline)) void store_four(Real* at, const Four<Real>& values) {
  __builtin_memcpy(at, &values, sizeof values);
}

/// Sets all but the first `count` of four numbers to 0, even if they are NaN.
template <class Real>
void clear_from(Index count, Four<Real>& values) {
  using Bits = typename FourOf<Real>::Bits;
  const auto limit = static_cast<typename FourOf<Real>::Integer>(count);
  const Bits kept = Bits{0, 1, 2, 3} < Bits{limit, limit, limit, limit};
  values = reinterpret_cast<Four<Real>>(reinterpret_cast<Bits>(values) & kept);
}

/// A block of four rows of four numbers, `stride` apart in memory.
template <class Real>
struct Block {
  Four<Real> row[4];

  void load(const Real* at, Index stride) {
    for (Index r = 0; r < 4; ++r) row[r] = load_four(at + r * stride);
  }
  void store(Real* at, Index stride) const {
    for (Index r = 0; r < 4; ++r) store_four(at + r * stride, row[r]);
  }
  void transpose() {
    const Four<Real> a = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    const Four<Real> b = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    const Four<Real> c = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    const Four<Real> d = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
  }
};

}  // namespace isosyrk
