// The isospectral midpoint rule in planar matrices, its structure used.
#pragma once

#include "isosyrk/fast/fast_form.h"

namespace isosyrk {

/// IsospectralMidpoint in fewer products: one unknown W̃, B = B(W̃),
///
///     W̃  = W₀ + (h/2) [B, W̃] + (h²/4) B W̃ B,     W₁ = W₀ + h [B, W̃]
///
/// with M = B W̃, [B, W̃] = M - M†, and M B skew-Hermitian; and of a correction δ to W̃
///
///     (1 - T)⁻¹ R = V R V†,  V = (1 - (h/2) B)⁻¹;   K δ = Z - Z†,  Z = B(δ) W̃ (h/2 + (h²/4) B)
///
/// with V by Newton's iteration V + V (1 - (1 - (h/2) B) V) from that of the correction before
/// (G. Schulz, ZAMM 13, 1933).
/// Products: 1 and a triangle a sweep; none for the update, which takes M from the last sweep; in
/// single precision 2 and more for V, 1 and a triangle for (1 - T)⁻¹ and 2 for K, all within bands.
class FastMidpoint final : public FastForm {
 public:
  FastMidpoint(const EulerZeitlin& flow, const FastOptions& options);

 protected:
  void start_cold() override;
  void begin() override;
  double sweep(double h) override;
  double residual(double h) override;
  Index linearise(double h, double accuracy) override;
  double transport(double h) override;
  bool solves_transport() const override { return true; }
  double couple(double h) override;
  void update(double h, PlanarMatrix& W1) override;

 private:
  void commute(double h);
  void invert(double h, double accuracy);
  static void set_sum(const SingleMatrix& X, double scale, double shift, SingleMatrix& Y,
                      Share share);

  PlanarMatrix W_stage_, B_, M_, MB_, commutator_;
  SingleMatrix W_single_, B_single_, X_, K_right_, dB_, product_, other_;
  SingleMatrix V_, minus_V_adjoint_;
  bool knows_V_ = false;
};

}  // namespace isosyrk
