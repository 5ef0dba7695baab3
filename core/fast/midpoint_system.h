// The isospectral midpoint rule in split-complex storage.
#pragma once

#include "isosyrk/fast/split_workspace.h"
#include "isosyrk/fast/stage_system.h"

namespace isosyrk {

/// IsospectralMidpoint for J = I: unknown W̃ - W₀, B = B(W̃),
///
///     W̃ = W₀ + (h/2) [B, W̃] + (h²/4) B W̃ B,     W₁ = W₀ + h [B, W̃]
///
/// with M = B W̃, [B, W̃] = M - M†, and M B skew-Hermitian; and of a correction δ to W̃
///
///     (1 - T)⁻¹ R = V R V†,  V = (1 - (h/2) B)⁻¹;   K δ = Z - Z†,  Z = B(δ) W̃ (h/2 + (h²/4) B)
///
/// with V by Newton's iteration V + V (1 - (1 - (h/2) B) V) from the V of the correction before
/// (G. Schulz, ZAMM 13, 1933).
///
/// Products: 1 and a triangle a residual; none for the update, which takes M from the last residual;
/// in single precision 2 and more for V, 1 and a triangle for (1 - T)⁻¹ and 2 for K, within bands.
class MidpointSystem final : public StageSystem {
 public:
  /// Throws std::invalid_argument for a flow that has no generator in split storage.
  MidpointSystem(const Flow& flow, int threads, bool truncates);

  Unknowns unknowns() const override { return {work_.zeros(1)}; }
  void bind(const SplitMatrix& W0, double h, double tolerance) override;
  void cold_start(Unknowns& x) override;
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  bool solves_frozen() const override { return true; }
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;
  bool truncates() const override { return work_.bands.enabled(); }
  void truncate(bool enabled) override { work_.bands.enable(enabled); }
  StepReport work() const override { return work_.work(); }

 private:
  void invert(double accuracy);

  SplitWorkspace work_;
  const SplitMatrix* W0_ = nullptr;
  double h_ = 0.0;
  SplitStages W_stage_, B_, M_, MB_, commutator_;
  SingleStages W_single_, B_single_, K_right_, dB_, product_, other_;
  SingleStages X_, V_, minus_V_adjoint_;  // X = 1 - (h/2) B
  bool knows_V_ = false;
};

}  // namespace isosyrk
