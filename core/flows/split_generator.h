// The generator of a flow in split-complex storage, for the fast forms.
#pragma once

#include <span>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// B of a flow on skew-Hermitian matrices (J = I), linear in W, in double and single precision. For
/// W within a band of at least 1, B(W) is within it too.
class SplitGenerator {
 public:
  virtual ~SplitGenerator() = default;

  /// Sets the upper triangles, diagonal included, of B_i = B(W_i) within a band, from those of W_i
  /// within it.  Entries of B_i beyond the band become 0 or stay.  B_i is not W_i.
  virtual void upper_within(Index band, std::span<const SplitMatrix> W,
                            std::span<SplitMatrix> B) const = 0;
  virtual void upper_within(Index band, std::span<const SingleMatrix> W,
                            std::span<SingleMatrix> B) const = 0;

  /// Returns ‖R‖_F of a rotation R that B(W) is computed with and left without, as
  /// Flow::rotation_left_out.  Reads the upper triangle of W.
  virtual double rotation_left_out(const SplitMatrix&) const { return 0.0; }

  /// Returns a c with ‖B(W)‖_F <= c ‖W‖_F.
  virtual double norm_bound() const = 0;
  /// True if B damps entries far from the diagonal, as Δ⁻¹ does.  The coupling through B is then
  /// computed within a band (Tuning::CouplingBand), otherwise in full.
  virtual bool damps_fine_scales() const = 0;
};

}  // namespace isosyrk
