// The equation of the exponential Lie-Poisson methods in split-complex storage.
#pragma once

#include "isosyrk/fast/coupling_nodes.h"
#include "isosyrk/fast/exponential_step.h"
#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/graded_gradient.h"
#include "isosyrk/fast/graded_series.h"
#include "isosyrk/fast/split_operations.h"
#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// The equation for Ω, formula (2) of integrators/EXPONENTIAL.md, and its residual:
///
///     Ω = h B̃(μ),   μ = φ₁(ad_Ω) W₀ = Σ_k T_k / (k+1),   T₀ = W₀,   T_k = [Ω, T_{k-1}] / k
///     R = h B̃(μ) - Ω
///
/// T_k are those of GradedSeries, B̃ = ∇F that of GradedGradient.  From the same T_k follow, for the
/// Jacobian, e^{s ad_Ω} W₀ = Σ_k s^k T_k at the nodes of its quadrature.
///
/// Products: 1 for each T_k, in double precision only where it has to be, and those of B̃ - B.
/// Poisson solves: those of B̃.
class ExponentialEquation {
 public:
  /// Of order 2, 4 or 6.  Operations and step must outlive it.  Only the constructor allocates.
  ExponentialEquation(SplitOperations& operations, const ExponentialStep& step, int order,
                      const FastOptions& options);

  /// Ω = h B(W₀), the first Picard sweep of order 2 from Ω = 0.
  void start_cold(SplitMatrix& Omega);

  /// Sets R and the states at the nodes, for one Ω that is cut to its band first.  R may err by the
  /// accuracy, in the Frobenius norm.  The change is NaN where a series fails.
  ResidualSize residual(SingleStages& R, SplitStages& Omega, AtNodes& states, double accuracy);

  /// B̃ and its derivative at the μ of the last residual.
  GradedGradient& gradient() { return gradient_; }

 private:
  bool form_average(AtNodes& states, const SplitMatrix& Omega, double error);
  void add_term(AtNodes& states);

  SplitOperations& operations_;
  const ExponentialStep& step_;
  GradedSeries series_;
  GradedGradient gradient_;
  SplitMatrix mu_;  // μ
  SplitMatrix v_;   // B̃(μ)
};

}  // namespace isosyrk
