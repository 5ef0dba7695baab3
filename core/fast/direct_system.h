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
class DirectSystem final : public RungeKuttaSystem {
 public:
  /// As RungeKuttaSystem.
  DirectSystem(const Flow& flow, const Tableau& tableau, int threads, bool truncates);

  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  void linearise(const Unknowns& x, double accuracy) override;
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override;
  void couple(Corrections& coupled, const Corrections& delta) override;
  void update(SplitMatrix& W1, const Unknowns& x) override;

 private:
  // Of the last residual.
  Generators B_;            // B_j
  SplitStages M_;           // M_j = B_j W̃_j
  SplitStages commutator_;  // [B_j, W̃_j]
  // Of the Jacobian, in single precision.
  SingleStages W_single_;       // W̃_j
  RoundedGenerators B_single_;  // B_j
  SingleStages dB_;             // B(δ_j)
  SingleStages product_;        // B_j δ_j or B(δ_j) W̃_j
  SingleStages product_skew_;   // product_ - product_†
};

}  // namespace isosyrk
