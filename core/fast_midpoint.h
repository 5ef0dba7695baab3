// The isospectral midpoint rule in planar matrices, its structure used.
#pragma once

#include "core/fast_form.h"

namespace isosyrk {

/// IsospectralMidpoint in fewer products: one unknown W̃, B = B(W̃),
///
///     W̃  = W₀ + (h/2) [B, W̃] + (h²/4) B W̃ B,     W₁ = W₀ + h [B, W̃]
///
/// with M = B W̃, [B, W̃] = M - M†, and M B skew-Hermitian.
/// Products: 1 and a triangle a sweep; none for the update, which takes M from the last sweep.
class FastMidpoint final : public FastForm {
 public:
  FastMidpoint(const EulerZeitlin& flow, const FastOptions& options);

 protected:
  void start_cold() override;
  void begin() override;
  double sweep(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  PlanarMatrix W_stage_, B_, M_, MB_, commutator_;
};

}  // namespace isosyrk
