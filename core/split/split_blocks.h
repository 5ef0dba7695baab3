// Blocks of 4 x 4 real numbers: what is transposed, or runs along diagonals, in planar matrices.
#pragma once

#include <cstdint>
#include <type_traits>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Four neighbouring real numbers; the compiler takes whatever vectors the processor has.
template <class Real>
struct FourOf {
  typedef Real type
      __attribute__((vector_size(4 * sizeof(Real)), aligned(sizeof(Real)), may_alias));
  using Integer = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Integer Bits __attribute__((vector_size(4 * sizeof(Real))));
};
template <class Real>
using Four = typename FourOf<Real>::type;

template <class Real>
Four<Real>& four(Real* at) {
  return *reinterpret_cast<Four<Real>*>(at);
}
template <class Real>
const Four<Real>& four(const Real* at) {
  return *reinterpret_cast<const Four<Real>*>(at);
}

/// Sets what follows the first `count` of four numbers to 0, NaN too.
template <class Real>
void clear_from(Index count, Four<Real>& values) {
  using Bits = typename FourOf<Real>::Bits;
  const auto limit = static_cast<typename FourOf<Real>::Integer>(count);
  const Bits kept = Bits{0, 1, 2, 3} < Bits{limit, limit, limit, limit};
  values = reinterpret_cast<Four<Real>>(reinterpret_cast<Bits>(values) & kept);
}

/// Four rows of four numbers.
template <class Real>
struct Block {
  Four<Real> row[4];

  void load(const Real* at, Index stride) {
    for (Index r = 0; r < 4; ++r) row[r] = four(at + r * stride);
  }
  void store(Real* at, Index stride) const {
    for (Index r = 0; r < 4; ++r) four(at + r * stride) = row[r];
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

/// squares(m) = Σ |W(r, c)|² over |r - c| = m, of all rows or a share of them.  squares: n numbers.
template <class Real>
void diagonal_squares(const PlanarMatrixOf<Real>& W, RealVector& squares, Share share = {});
/// The same of a skew-Hermitian matrix whose upper triangle is read, for m = first ... end - 1.
void diagonal_squares_of_skew(const PlanarMatrix& W, Index first, Index end, RealVector& squares);
/// The smallest band outside which entries with those squares come to at most `tail` in the
/// Frobenius norm.
template <class Squares>
Index smallest_band(const Squares& squares, double tail) {
  double outside = 0.0;
  for (Index band = squares.size() - 1; band > 0; --band) {
    outside += squares(band);
    if (!(outside <= tail * tail)) return band;  // NaN included
  }
  return 0;
}

/// Sets what lies outside a band of W to 0, or a share of it.
template <class Real>
void cut_to_band(Index band, PlanarMatrixOf<Real>& W, Share share = {});

/// Fills the lower triangle of a skew-Hermitian matrix, or a share of it, from the upper:
/// C(r, c) = -conj(C(c, r)), the diagonal imaginary.
template <class Real>
void mirror_skew(PlanarMatrixOf<Real>& C, Share share = {});
/// The same within a band, to which C is cut.
template <class Real>
void mirror_skew_within(Index band, PlanarMatrixOf<Real>& C, Share share = {});

/// out = scale (C - C†), exactly skew-Hermitian, or a share of it.  out is not C.
template <class Real>
void skew_part(const PlanarMatrixOf<Real>& C, std::type_identity_t<Real> scale,
               PlanarMatrixOf<Real>& out, Share share = {});

/// The upper triangle of C - C† within a band, or a share of it; the rest of out stays as it was.
template <class Real>
void upper_skew_part_within(Index band, const PlanarMatrixOf<Real>& C, PlanarMatrixOf<Real>& out,
                            Share share = {});

/// out = -C†, or a share of it.  out is not C.
template <class Real>
void minus_adjoint(const PlanarMatrixOf<Real>& C, PlanarMatrixOf<Real>& out, Share share = {});

/// out -= scale C†, or a share of its rows.  out is not C.
template <class Real>
void subtract_adjoint(const PlanarMatrixOf<Real>& C, std::type_identity_t<Real> scale,
                      PlanarMatrixOf<Real>& out, Share share = {});

}  // namespace isosyrk
