// How large the terms of the gradient of the modified Hamiltonian are, and how precise they must
// be.
#pragma once

#include <array>

#include "isosyrk/split/split_matrix.h"

namespace isosyrk {

/// Terms of B̃(μ) beyond B(μ).
struct GradientTerms {
  bool second = false;  ///< h² ∇F₂
  bool fourth = false;  ///< h⁴ ∇F₄

  bool any() const { return second || fourth; }
  /// Returns these terms without those.
  GradientTerms operator-(GradientTerms those) const {
    return {second && !those.second, fourth && !those.fourth};
  }
};

/// Sizes of the terms h² ∇F₂(μ) and h⁴ ∇F₄(μ) beside ‖B(μ)‖_F, and what follows from them: whether
/// a term may be formed in single precision, and how much may be cut from the matrices that it is
/// made of.
///
/// Both are judged by what the terms are made of, since they are differences: near a steady state
/// [v, μ] cancels, and the rounding of v = B(μ) and of μ does not, nor what is cut from them.
///
/// - Rounding.  Single precision leaves in the term in h² an error of 0.04 u h² ‖v‖_F ‖μ‖_F / n
///   beside ‖v‖_F, u = Tuning::single_roundoff: 0.003 to 0.2 in place of 0.04 for smooth, rough and
///   steady states of every l, n = 5 to 129.
/// - Bands.  A part p of μ that is cut changes the term as it changes that of a state without
///   symmetry, whose term is 0.01 h² ‖μ‖_F² / n beside ‖v‖_F or more (the same states, n >= 17).
///
/// A term is therefore taken to be as large as was guessed or seen, and at least as large as that.
class TermSizes {
 public:
  /// For the terms of order 4 or 6.
  explicit TermSizes(GradientTerms all) : all_(all) {}

  /// Begins an evaluation at μ with v = B(μ).  The accuracy is relative to ‖v‖_F, or to `least` if
  /// that is more.  The terms together have about the norm `guess`, and that in h⁴ the part of it
  /// that it has in a state without symmetry.
  void begin(const SplitMatrix& v, const SplitMatrix& mu, double h, double accuracy, double least,
             double guess);
  /// Takes the norm of a term, or of the sum of both as that of the term in h².
  void record(GradientTerms which, double norm);

  /// Returns those terms that may be formed in single precision.
  GradientTerms in_single() const;
  /// Returns the part that may be cut from each matrix that the terms are made of.
  double part_to_cut() const;
  /// True if the sizes that were recorded since allow what was formed in single precision.
  bool allow_rounding(GradientTerms in_single) const;
  /// The same of the part that was cut.
  bool allow_cut(double part) const;

  /// Returns the expected part of B(μ) that the term in h² is, for a state without symmetry,
  /// whatever cancels.
  double share_of_second() const;
  /// Returns the same of the term in h⁴ for its derivative, which does not cancel where v is a
  /// multiple of μ: made of v in place of μ where v is larger, as at large scales.
  double share_of_derivative_of_fourth() const;

 private:
  double share_of_fourth() const;
  bool is_single(std::size_t term) const;
  bool rounds_well(std::size_t term) const;

  GradientTerms all_;
  double accuracy_ = 0.0;
  double whole_ = 0.0;                         // norm to which shares and the accuracy are relative
  std::array<double, 2> shares_ = {1.0, 1.0};  // sizes of the terms, as guessed or seen
  // What the shares would be without symmetry, at least, and what counts for rounding.
  std::array<double, 2> typical_ = {0.0, 0.0};
  std::array<double, 2> rounded_ = {0.0, 0.0};
  double of_derivative_ = 0.0;
};

}  // namespace isosyrk
