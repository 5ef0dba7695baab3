// The gradient of the modified Hamiltonian, each term in the precision that it needs.
#pragma once

#include "isosyrk/fast/split_lie.h"
#include "isosyrk/fast/term_sizes.h"
#include "isosyrk/integrators/modified_gradient.h"

namespace isosyrk {

/// B̃(μ) = v + h² ∇F₂(μ) + h⁴ ∇F₄(μ), v = B(μ), of integrators/EXPONENTIAL.md, section 4, to a
/// wanted accuracy, and the derivative of its term in h².  The terms are those of
/// ModifiedGradient.
///
/// They are small beside v.  So they may err by a larger part of themselves, be formed in single
/// precision, and from matrices that are cut to narrow bands, as TermSizes says.  Ω / h - v is a
/// guess of their sum.  A term that turns out larger, so that its precision or its bands do not
/// suffice, is formed again.
class GradedGradient {
 public:
  /// Of order 2, 4 or 6.  Both kinds of operations must outlive it.  Only the constructor
  /// allocates.
  GradedGradient(SplitLie<double>& lie, SplitLie<float>& single_lie, Index n, int order);

  /// What is wanted of B̃.
  struct Wanted {
    double h;
    double accuracy;  ///< relative to ‖B(μ)‖_F, or to `least` if that is more
    double least;
  };
  /// v = B̃(mu), where mu is cut to its band first.  Ω is about h v.
  void evaluate(SplitMatrix& v, SplitMatrix& mu, const SplitMatrix& Omega, const Wanted& wanted);

  /// out = h² (∇F₂)'(μ) D with BD = B(D), at the μ of the last evaluate(), in single precision.
  /// What the factors are made of is cut as the operations say.
  void derivative_of_second(SingleMatrix& out, const SingleMatrix& D, const SingleMatrix& BD,
                            double h);

  /// Sizes of the terms at the μ of the last evaluate().
  const TermSizes& sizes() const { return sizes_; }

 private:
  double cut(const SplitMatrix& v, const SplitMatrix& mu);
  bool suffices(double part) const;
  void form(const SplitMatrix& v, const SplitMatrix& mu, double h);

  SplitLie<double>& lie_;
  SplitLie<float>& single_lie_;
  GradientTerms all_;  // of the order
  TermSizes sizes_;
  ModifiedGradient<SplitLie<double>> gradient_;
  ModifiedGradient<SplitLie<float>> single_gradient_;
  SingleMatrix mu_, v_;  // μ and B(μ), cut to what the terms need
  GradientTerms in_double_, in_single_;
  SplitMatrix terms_;           // the sum of those in double precision
  SingleMatrix terms_single_;   // and of those in single precision
  bool is_linearized_ = false;  // single_gradient_ has what its derivative needs
};

}  // namespace isosyrk
