// The exponential Lie-Poisson methods in split-complex storage.
#pragma once

#include "isosyrk/fast/explicit_start.h"
#include "isosyrk/fast/exponential_equation.h"
#include "isosyrk/fast/exponential_jacobian.h"
#include "isosyrk/fast/exponential_update.h"
#include "isosyrk/fast/stage_system.h"

namespace isosyrk {

/// ExponentialLiePoisson of order 2, 4 or 6 for J = I, with the unknown Ω, of four parts:
///
///     Ω  = h B̃(μ),   μ = φ₁(ad_Ω) W₀         ExponentialEquation
///     (1 - K - E) δ = h B̃(μ) - Ω             ExponentialJacobian: corrections of Ω
///     Ω⁰ of magnus4 or magnus5               ExplicitStart
///     W₁ = e^Ω W₀ e^(-Ω)                     ExponentialUpdate
///
/// integrators/EXPONENTIAL.md says which file has which of its formulas.  Tolerance and accuracy
/// are relative to ‖Ω‖_F, or to more as in the published form (integrators/unit_of_exponent.h).  A
/// step is isospectral for any Ω, and Lie-Poisson to the tolerance.  Work: that of the parts.
class ExponentialSystem final : public StageSystem {
 public:
  /// Bands are truncated if options.bands is true.  Throws std::invalid_argument for a flow without
  /// a generator in split-complex storage, and for threads out of range.
  ExponentialSystem(const Flow& flow, int order, const FastOptions& options = {});

  Unknowns unknowns() const override { return {split_stages(1, operations_.size())}; }
  /// Newton from past steps, from an explicit step and from a cold start; then Picard and Anderson.
  std::vector<Attempt> attempts(bool newton) const override;
  /// ExponentialMemory.
  std::unique_ptr<StepMemory> memory() const override;
  void bind(const SplitMatrix& W0, double h, double tolerance, StepMemory& memory) override;
  /// Explicit: that of ExplicitStart.  Cold, or where there is none: Ω = h B(W₀).
  void start(Unknowns& x, Start how) override;
  ResidualSize residual(Corrections& R, Unknowns& x, double accuracy) override {
    return equation_.residual(R[0], x[0], jacobian_.states(), accuracy);
  }
  Correction correct(Corrections& delta, const Unknowns& x, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options) override {
    return jacobian_.correct(delta, x[0][0], R, request, options);
  }
  double unit(const Unknowns& x) const override { return step_.unit(x[0][0]); }
  /// By the estimated error of a correction, unless options.error_estimates is false.
  ConvergenceTest convergence_test(const Unknowns& x, double tolerance,
                                   IterationMemory& memory) const override;
  /// W1 is not finite where ‖Ω‖ is beyond SplitExponential.
  void update(SplitMatrix& W1, const Unknowns& x) override;

  bool truncates() const override { return operations_.bands.enabled(); }
  void truncate(bool enabled) override { operations_.bands.enable(enabled); }
  Work work() const override { return operations_.work(); }
  void archive_work(StateArchive& run) override { operations_.archive_work(run); }

 private:
  Acceptance acceptance_;
  bool starts_explicitly_;
  SplitOperations operations_;
  ExponentialStep step_;
  ExponentialEquation equation_;
  ExponentialJacobian jacobian_;
  ExponentialUpdate update_;
  ExplicitStart explicit_start_;
};

}  // namespace isosyrk
