// The generator of a flow in split-complex storage: what a flow offers to the fast forms.
#pragma once

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// B of a flow on skew-Hermitian matrices (J = I), linear in W, in double and single precision.
class SplitGenerator {
 public:
  virtual ~SplitGenerator() = default;

  /// The upper triangles, diagonal included, of B_i = B(W_i) from those of W_i.  B_i is not W_i.
  virtual void upper(const SplitStages& W, SplitStages& B) const = 0;
  /// The same in single precision within a band; beyond it B_i stays as it was.
  virtual void upper_within(Index band, const SingleStages& W, SingleStages& B) const = 0;

  /// A number c with ‖B(W)‖_F <= c ‖W‖_F.
  virtual double norm_bound() const = 0;
  /// Whether B damps what lies far from the diagonal, as Δ⁻¹ does.  Then a change of W acts through
  /// a narrow band of B in single precision (Tuning::coupling_band); otherwise all of it counts.
  virtual bool damps_fine_scales() const = 0;
};

}  // namespace isosyrk
