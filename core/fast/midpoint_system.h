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

  /// That of V.
  std::unique_ptr<StepMemory> memory() const override;
  void bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) override;
  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override;
  void linearise(const Unknowns& x, double accuracy) override;
  double frozen_sweep(Corrections& delta, const Corrections& rhs) override;
  bool solves_frozen() const override { return true; }
  void couple(Corrections& coupled, const Corrections& delta) override;
  void update(SplitMatrix& W1, const Unknowns& x) override;

 private:
  // The inverse of an earlier correction.
  struct Memory final : StepMemory {
    explicit Memory(Index n) : V(split_stages<float>(1, n)) {}
    void forget() override { knows_V = false; }
    void archive(StateArchive& state) override { state.pass(knows_V, V); }

    SingleStages V;  // V = X⁻¹
    bool knows_V = false;
  };

  void invert(SingleStages& V, double accuracy);

  Memory* memory_ = nullptr;  // of the step
  // Of the last residual: single matrices.
  SplitStages W_stage_;     // W̃
  Generators B_;            // B
  SplitStages M_;           // M = B W̃
  SplitStages MB_;          // (h²/4) B W̃ B
  SplitStages commutator_;  // (h/2) [B, W̃]
  // Of the Jacobian, in single precision.
  SingleStages W_single_;         // W̃
  RoundedGenerators B_single_;    // B
  SingleStages X_;                // X = 1 - (h/2) B
  SingleStages minus_V_adjoint_;  // -V†
  SingleStages K_right_;          // h/2 + (h²/4) B
  SingleStages dB_;               // B(δ)
  SingleStages product_, other_;  // of a product and of the next one
};

}  // namespace isosyrk
