// The isospectral midpoint rule in split-complex storage.
#pragma once

#include "isosyrk/fast/split_system.h"

namespace isosyrk {

/// IsospectralMidpoint for J = I, with the unknown W̃ - W₀.  With B = B(W̃) the equations are
///
///     W̃ = W₀ + (h/2) [B, W̃] + (h²/4) B W̃ B,     W₁ = W₀ + h [B, W̃]
///
/// where [B, W̃] = M - M† with M = B W̃, and M B is skew-Hermitian.  For a correction δ to W̃ the
/// inverse of 1 - T and the coupling are
///
///     (1 - T)⁻¹ R = V R V†,  V = (1 - (h/2) B)⁻¹;   K δ = Z - Z†,  Z = B(δ) W̃ (h/2 + (h²/4) B)
///
/// V is computed by the Newton-Schulz iteration V <- V + V (1 - (1 - (h/2) B) V), which starts from
/// the V of the correction before.  The update uses M of the last residual.
/// Products in double precision: 1 and 1 triangle a residual, none for the update.
/// Products in single precision, within bands: 2 for each iteration for V; 1 and 1 triangle for
/// (1 - T)⁻¹; 2 for K.
/// Poisson solves: 1 a residual, none for the update, 1 for K.
/// Source: IsospectralMidpoint; G. Schulz, ZAMM 13, 1933.
class MidpointSystem final : public SplitSystem {
 public:
  /// As SplitSystem.
  MidpointSystem(const Flow& flow, int threads, bool truncates);

  Unknowns unknowns() const override { return {work_.zeros(1)}; }
  void cold_start(Unknowns& x) override;
  double residual(Unknowns& x, double accuracy, Corrections& R) override;
  void linearise(double accuracy) override;
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override;
  bool solves_frozen() const override { return true; }
  void couple(const Corrections& delta, Corrections& coupled) override;
  void update(const Unknowns& x, SplitMatrix& W1) override;

 private:
  void invert(double accuracy);

  SplitStages W_stage_, B_, M_, MB_, commutator_;
  SingleStages W_single_, B_single_, K_right_, dB_, product_, other_;
  SingleStages X_, V_, minus_V_adjoint_;  // X = 1 - (h/2) B
  bool knows_V_ = false;                  // V_ holds the inverse of an earlier correction
};

}  // namespace isosyrk
