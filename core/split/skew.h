// Skew-Hermitian parts, mirrored triangles and adjoints of split matrices, by blocks of 4 x 4.
#pragma once

#include <type_traits>

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Fills the lower triangle of a skew-Hermitian matrix from the upper, or the share of it:
/// C(r, c) = -conj(C(c, r)), the diagonal imaginary.
template <class Real>
void mirror_skew(SplitMatrixOf<Real>& C, Share share = {});
/// The same within a band, to which C is cut.
template <class Real>
void mirror_skew_within(Index band, SplitMatrixOf<Real>& C, Share share = {});
/// Both of all C_i.
template <class Real>
void mirror_skew(SplitStagesOf<Real>& C);
template <class Real>
void mirror_skew_within(Index band, SplitStagesOf<Real>& C);

/// out_i = scale (C_i - C_i†), exactly skew-Hermitian.  out_i is not C_i.
template <class Real>
void skew_part(const SplitStagesOf<Real>& C, std::type_identity_t<Real> scale,
               SplitStagesOf<Real>& out);

/// The upper triangle of C_i - C_i† within a band; the rest of out_i stays as it was.
template <class Real>
void upper_skew_part_within(Index band, const SplitStagesOf<Real>& C, SplitStagesOf<Real>& out);

/// out_i = -C_i†.  out_i is not C_i.
template <class Real>
void minus_adjoint(const SplitStagesOf<Real>& C, SplitStagesOf<Real>& out);

}  // namespace isosyrk
