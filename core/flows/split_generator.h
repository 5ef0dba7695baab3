// The generator of a flow in split-complex storage, for the fast forms.
#pragma once

#include <span>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// B of a flow on skew-Hermitian matrices (J = I), linear in W, in double and single precision.  A
/// W within a band has a B(W) within the same band, of at least 1.
class SplitGenerator {
 public:
  virtual ~SplitGenerator() = default;

  /// Sets the upper triangles, diagonal included, of B_i = B(W_i), from the upper triangles of W_i.
  /// B_i is not W_i.
  virtual void upper(std::span<const SplitMatrix> W, std::span<SplitMatrix> B) const = 0;
  /// As upper(), for W_i within a band.  Entries of B_i beyond the band are unspecified.
  virtual void upper_of_banded(Index /*band*/, std::span<const SplitMatrix> W,
                               std::span<SplitMatrix> B) const {
    upper(W, B);
  }
  /// As upper(), in single precision, within a band.  Entries of B_i beyond the band are
  /// unspecified.
  virtual void upper_within(Index band, std::span<const SingleMatrix> W,
                            std::span<SingleMatrix> B) const = 0;

  /// Returns a c with ‖B(W)‖_F <= c ‖W‖_F.
  virtual double norm_bound() const = 0;
  /// True if B damps entries far from the diagonal, as Δ⁻¹ does.  The coupling through B is then
  /// computed within a band (Tuning::CouplingBand), otherwise in full.
  virtual bool damps_fine_scales() const = 0;
};

}  // namespace isosyrk
