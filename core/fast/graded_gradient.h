// The gradient of the modified Hamiltonian, each term in the precision that it needs.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "isosyrk/fast/split_lie.h"
#include "isosyrk/fast/split_modified_gradient.h"

namespace isosyrk {

/// B̃(μ) of SplitModifiedGradient to a wanted accuracy, and the derivative of its term in h².
///
/// The terms in h² and h⁴ are small beside B(μ).  So they may err by a larger part of themselves,
/// be formed in single precision, and from matrices that are cut to narrow bands.  How far is
/// judged by what they are made of, since they are differences: near a steady state [v, μ] cancels,
/// and the rounding of v and μ does not, nor what is cut from them.
///
/// - Rounding.  Single precision leaves in the term in h² an error of 0.04 u h² ‖v‖_F ‖μ‖_F / n
///   beside ‖v‖_F, u = Tuning::single_roundoff: 0.003 to 0.2 in place of 0.04 for smooth, rough and
///   steady states of every l, n = 5 to 129.
/// - Bands.  A part p of μ that is cut changes the term as it changes that of a state without
///   symmetry, whose term is 0.01 h² ‖μ‖_F² / n beside ‖v‖_F or more (the same states, n >= 17).
///
/// A term is therefore taken to be as large as was seen, and at least as large as that.  Its size
/// as seen in the residual before is a guess.  A term that turns out larger, so that its precision
/// or its bands do not suffice, is formed again.
class GradedGradient {
 public:
  /// Of order 2, 4 or 6.  Both kinds of operations must outlive it.  Only the constructor
  /// allocates.
  GradedGradient(SplitLie<double>& lie, SplitLie<float>& single_lie, Index n, int order);

  /// Sizes of the terms, as a residual leaves them to the next one.
  struct Memory {
    std::array<double, 2> shares = {1.0, 1.0};  ///< ‖h² ∇F₂‖ and ‖h⁴ ∇F₄‖ as parts of ‖B(μ)‖
    bool knows_shares = false;  ///< false until they were seen
  };
  /// Forgets the sizes of the terms.
  void forget() { knows_shares_ = false; }
  /// Exchanges them with others.
  void exchange_memory(Memory& other) {
    std::swap(shares_, other.shares);
    std::swap(knows_shares_, other.knows_shares);
  }

  /// v = B̃(mu), where mu is cut to its band first.  The accuracy is relative to ‖B(mu)‖_F, or to
  /// `least` if that is more.  Ω is about h v.
  void evaluate(SplitMatrix& v, SplitMatrix& mu, const SplitMatrix& Omega, double h,
                double accuracy, double least);

  /// Expected part of B(μ) that the terms in h² and h⁴ are, as of the last evaluate(): for a state
  /// without symmetry, whatever cancels.
  double share_of_second() const { return std::max(shares_[0], typical_[0]); }
  double share_of_fourth() const { return std::max(shares_[1], typical_[1]); }
  /// The same of the term in h⁴ for its derivative, which does not cancel where v is a multiple of
  /// μ: made of v in place of μ where v is larger, as at large scales.
  double share_of_derivative_of_fourth() const { return std::max(shares_[1], of_derivative_); }

  /// out = h² (∇F₂)'(μ) D with BD = B(D), at the μ of the last evaluate().  What the factors are
  /// made of is cut as the operations in single precision say.
  void derivative_of_second(SingleMatrix& out, const SingleMatrix& D, const SingleMatrix& BD,
                            double h);

 private:
  struct Terms {
    bool second;
    bool fourth;
    bool any() const { return second || fourth; }
  };

  void measure(const SplitMatrix& v, const SplitMatrix& mu, double h, double least);
  bool is_single(std::size_t term) const;
  double part_to_cut() const;
  bool suffices(Terms in_single, double part) const;
  void round_and_cut(const SplitMatrix& v, const SplitMatrix& mu, double part);
  void form_in_single(Terms which, double h);
  void form_in_double(Terms which, const SplitMatrix& v, const SplitMatrix& mu, double h);

  SplitLie<double>& lie_;
  SplitLie<float>& single_lie_;
  int order_;
  SplitModifiedGradient<double> gradient_;
  SplitModifiedGradient<float> single_gradient_;
  SingleMatrix mu_, v_;  // μ and v = B(μ)
  SplitMatrix terms_;    // in double precision
  SingleMatrix terms_single_;
  bool is_linearized_ = false;  // single_gradient_ has what its derivative needs

  // Of evaluate().
  double accuracy_ = 0.0;
  double whole_ = 0.0;  // norm to which shares and the accuracy are relative
  // ‖h² ∇F₂‖ and ‖h⁴ ∇F₄‖ as parts of that, last seen: the second alone in the first evaluation of
  // a run, later in the first number, as the norm of their sum.  At first, what both may be at
  // most.
  std::array<double, 2> shares_ = {1.0, 1.0};
  bool knows_shares_ = false;
  // What they would be without symmetry, at least, and what counts for rounding.
  std::array<double, 2> typical_ = {0.0, 0.0};
  std::array<double, 2> rounded_ = {0.0, 0.0};
  double of_derivative_ = 0.0;
};

}  // namespace isosyrk
