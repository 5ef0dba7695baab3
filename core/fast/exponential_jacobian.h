// The Jacobian of the equation of the exponential Lie-Poisson methods, and its correction.
#pragma once

#include "isosyrk/fast/exponential_coupling.h"
#include "isosyrk/fast/fast_options.h"
#include "isosyrk/fast/graded_gradient.h"

namespace isosyrk {

/// Corrections δ that solve (1 - K - E) δ = R, where K + E is the derivative of h B̃(μ(Ω)) by Ω.
///
/// K is that of h B (ExponentialCoupling).  E is that of the term of B̃ in h², with the D of K δ,
/// formula (7) of integrators/EXPONENTIAL.md:
///
///     E δ = h³ (∇F₂)'(μ) D
///
/// K smooths and contracts by about 0.1, and E δ is about as small beside δ as the term beside B.
/// So
///
///     δ = Σ_k δ_k,   (1 - K) δ₀ = R,   (1 - K) δ_k = E δ_{k-1},
///
/// each by a Neumann series (NeumannCorrection).  δ_k is formed where E δ_{k-1} shows.  What is
/// left out of E, and the derivative of the term in h⁴, enter the estimated error.
///
/// In single precision.  Products: those of K, and 6 of E δ.  Poisson solves: those of K, 3 of E δ.
class ExponentialJacobian {
 public:
  /// Of order 2, 4 or 6, with the derivative of the term in h² from `gradient`.  All that is taken
  /// must outlive it.  Only the constructor allocates.
  ExponentialJacobian(SplitOperations& operations, const ExponentialStep& step,
                      GradedGradient& gradient, int order, const FastOptions& options);

  /// The states from which K is formed.  A residual sets them.
  AtNodes& states() { return coupling_.states(); }

  /// Sets delta to δ, for the Ω and the states of the last residual.
  Correction correct(Corrections& delta, const SplitMatrix& Omega, const Corrections& R,
                     const CorrectionRequest& request, const IterationOptions& options);

  /// Returns a factor by which a Picard sweep contracts, or less.
  double least_contraction() const { return coupling_.least_contraction(); }

 private:
  Correction solve(Corrections& delta, const Corrections& R, const CorrectionRequest& request,
                   double size_of_E, const IterationOptions& options);
  void form_E_delta(double part);

  SplitLie<float>& lie_;
  const ExponentialStep& step_;
  GradedGradient& gradient_;
  int order_;
  ExponentialCoupling coupling_;
  NeumannCorrection neumann_;
  Corrections E_delta_;     // E δ_{k-1}
  Corrections next_delta_;  // δ_k
  SingleMatrix B_of_sum_;   // B of the sum of D
};

}  // namespace isosyrk
