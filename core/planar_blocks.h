// Blocks of 4 x 4 real numbers: what is transposed, or runs along diagonals, in planar matrices.
#pragma once

#include <cstdint>

#include "core/planar_matrix.h"

namespace isosyrk {

/// Four neighbouring real numbers; the compiler takes whatever vectors the processor has.
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

inline Four& four(double* at) { return *reinterpret_cast<Four*>(at); }
inline const Four& four(const double* at) { return *reinterpret_cast<const Four*>(at); }

/// Sets what follows the first `count` of four numbers to 0, NaN too.
inline void clear_from(Index count, Four& values) {
  typedef std::int64_t Bits __attribute__((vector_size(32)));
  const auto limit = static_cast<std::int64_t>(count);
  const Bits kept = Bits{0, 1, 2, 3} < Bits{limit, limit, limit, limit};
  values = reinterpret_cast<Four>(reinterpret_cast<Bits>(values) & kept);
}

/// Four rows of four numbers.
struct Block {
  Four row[4];

  void load(const double* at, Index stride) {
    for (Index r = 0; r < 4; ++r) row[r] = four(at + r * stride);
  }
  void store(double* at, Index stride) const {
    for (Index r = 0; r < 4; ++r) four(at + r * stride) = row[r];
  }
  void transpose() {
    const Four a = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
    const Four b = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    const Four c = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
    const Four d = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
  }
};

/// Fills the lower triangle of a skew-Hermitian matrix from the upper:  C(r, c) = -conj(C(c, r)),
/// the diagonal imaginary.
void mirror_skew(PlanarMatrix& C);

/// out = scale (C - C†), exactly skew-Hermitian.  out is not C.
void skew_part(const PlanarMatrix& C, double scale, PlanarMatrix& out);

/// out = -C†.  out is not C.
void minus_adjoint(const PlanarMatrix& C, PlanarMatrix& out);

}  // namespace isosyrk
