// Gauss methods applied to W itself, in split-complex storage: a control without structure.
#pragma once

#include "isosyrk/fast/split_system.h"

namespace isosyrk {

/// DirectForm for J = I, with the unknowns W̃_i.  With B_j = B(W̃_j) the equations are
///
///     W̃_i = W₀ + h Σ_j a_ij [B_j, W̃_j],     W₁ = W₀ + h Σ_j b_j [B_j, W̃_j]
///
/// where [B_j, W̃_j] = M_j - M_j† with M_j = B_j W̃_j.  For corrections δ_j to W̃_j
///
///     (T δ)_i = h Σ_j a_ij [B_j, δ_j],     (K δ)_i = h Σ_j a_ij [B(δ_j), W̃_j]
///
/// The update uses M_j of the last residual.
/// Products: s a residual in double, s a frozen sweep and s a coupling in single precision.
/// Poisson solves: s a residual, s a coupling.
class DirectSystem final : public SplitSystem {
 public:
  /// As SplitSystem.
  DirectSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  Unknowns unknowns() const override { return {work_.zeros(s_)}; }
  void cold_start(Unknowns& x) override;
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;

 private:
  const SplitStages* W_stage_ = nullptr;  // of the last residual
  SplitStages B_, M_, commutator_;
  SingleStages W_single_, B_single_, dB_, product_, product_skew_;
};

}  // namespace isosyrk
