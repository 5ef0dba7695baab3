// Skew-Hermitian parts, mirrored triangles and adjoints of split matrices, in small blocks.
#pragma once

#include "isosyrk/split/parallel.h"
#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Fills the lower triangle of a skew-Hermitian matrix from the upper one, in a share of C:
/// C(r, c) = -conj(C(c, r)) for r > c.  The real part of the diagonal becomes 0.
template <class Real>
void mirror_skew(SplitMatrixOf<Real>& C, Share share = {});
/// As mirror_skew within a band.  Sets C to 0 outside the band, and C.band().
template <class Real>
void mirror_skew_within(SplitMatrixOf<Real>& C, Index band, Share share = {});
/// mirror_skew of all C_i.
template <class Real>
void mirror_skew(SplitStagesOf<Real>& C);
/// mirror_skew_within of all C_i.
template <class Real>
void mirror_skew_within(SplitStagesOf<Real>& C, Index band);

/// out_i = scale (C_i - C_i†), exactly skew-Hermitian.  out_i is not C_i.
template <class Real>
void skew_part(SplitStagesOf<Real>& out, const SplitStagesOf<Real>& C, double scale = 1.0);

/// out_i = C_i - C_i† in the upper triangle within a band.  Other entries of out_i are unchanged.
template <class Real>
void upper_skew_part_within(SplitStagesOf<Real>& out, Index band, const SplitStagesOf<Real>& C);

/// out_i = -C_i†.  out_i is not C_i.
template <class Real>
void minus_adjoint(SplitStagesOf<Real>& out, const SplitStagesOf<Real>& C);

// The same for one matrix, of which threads take a share each.

/// out = scale (C - C†), exactly skew-Hermitian.  out is not C.
template <class Real>
void skew_part(SplitMatrixOf<Real>& out, const SplitMatrixOf<Real>& C, double scale = 1.0);
/// mirror_skew of C, whose upper triangle must be 0 outside C.band().  The lower one becomes so.
template <class Real>
void mirror_all_skew(SplitMatrixOf<Real>& C);
/// mirror_skew of C within C.band(), outside which both triangles must be 0.
template <class Real>
void mirror_skew_in_band(SplitMatrixOf<Real>& C);
/// Fills the lower triangle of a Hermitian matrix from the upper one: C(r, c) = conj(C(c, r)).  The
/// imaginary part of the diagonal becomes 0.  The upper triangle must be 0 outside C.band(), and
/// the lower one becomes so.
template <class Real>
void mirror_all_hermitian(SplitMatrixOf<Real>& C);

}  // namespace isosyrk
