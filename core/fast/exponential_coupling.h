// The coupling K of the Jacobian of the exponential Lie-Poisson methods.
#pragma once

#include "isosyrk/fast/coupling_nodes.h"
#include "isosyrk/fast/exponential_step.h"
#include "isosyrk/fast/split_operations.h"
#include "isosyrk/solver/neumann_correction.h"

namespace isosyrk {

/// K δ = h B(D), where D is the derivative of μ = φ₁(ad_Ω) W₀ by Ω, applied to δ:
///
///     D = ∫₀¹ [s Σ_j s^j c_j, e^{s ad_Ω} W₀] ds,   c₀ = δ,   c_j = [Ω, c_{j-1}] / (j+1)
///
/// by Gauss quadrature of weight s at two nodes, (6 ∓ √6)/10.  This is formula (6) of
/// integrators/EXPONENTIAL.md.
///
/// Products, in single precision: 1 for each c_j and 1 for each node.  Poisson solves: 1.
class ExponentialCoupling final : public Coupling {
 public:
  /// Operations and step must outlive it.  Only the constructor allocates.
  ExponentialCoupling(SplitOperations& operations, const ExponentialStep& step, bool is_graded);

  /// The states e^{s ad_Ω} W₀, from which K is formed.  A residual sets them.
  AtNodes& states() { return states_; }

  /// Fixes K at Ω and at the states of the last residual.  This part of their norms may be cut.
  void linearize(const SplitMatrix& Omega, double part);
  /// Sets `coupled` to K δ.
  void couple(Corrections& coupled, const Corrections& delta, double accuracy) override;

  /// Returns the error of the quadrature in K δ, for a δ of this size and an Ω of this norm.
  double error_of_quadrature(double size, double size_of_Omega) const;

  /// From here on, sums D over all δ to which K is applied, or does not.
  void sum_D(bool is_wanted);
  /// True if a sum was wanted and K was applied.
  bool has_sum_of_D() const { return has_sum_of_D_; }
  SingleMatrix& sum_of_D() { return sum_of_D_; }

  /// Returns a factor by which K contracts, or less.
  double least_contraction() const;

 private:
  void sum_series(const SingleMatrix& delta, double size, double accuracy);
  void integrate();
  void add_to_sum_of_D();

  SplitLie<float>& lie_;
  const ExponentialStep& step_;
  bool is_graded_;
  SingleMatrix Omega_;
  AtNodes states_;           // e^{s ad_Ω} W₀
  AtNodes sums_;             // Σ_j s^j c_j
  SingleMatrix c_, next_c_;  // c_j and c_{j+1}
  SingleMatrix D_, BD_;      // D and B(D)
  SingleMatrix sum_of_D_;
  bool sums_D_ = false;
  bool has_sum_of_D_ = false;
};

}  // namespace isosyrk
