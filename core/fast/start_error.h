// The error of explicit start values, foretold from the step before.
#pragma once

#include "isosyrk/split/linear_combination.h"

namespace isosyrk {

/// Adds to explicit start values Ω⁰ of a step the error E = Ω - Ω⁰ that they are expected to have.
///
/// E is made of brackets of W and B(W).  The flow transports its fine scales with those of W; its
/// large scales hardly move.  So the E_m of step m is transported by its U_m = e^{Ω_m}:
///
///     E_{m+1} ≈ U_m E_m U_m†
///
/// Of the error of magnus4 this leaves a twentieth in the rough scene (n = 33 and 65, elp4_frame,
/// h = 0.36), and a quarter to a half in the smooth one (h = 1).
///
/// In single precision: E is small beside Ω.
class StartError {
 public:
  /// For n x n matrices.  Only the constructor allocates.
  explicit StartError(Index n)
      : explicit_(split_stages(1, n)), error_(split_stages<float>(1, n)), transported_(n) {}

  /// Forgets all steps.
  void forget() { is_known_ = is_of_this_step_ = false; }
  /// The error of the last step.  Between steps Ω⁰ is of none.
  void archive(StateArchive& state) { state.pass(is_known_, size_of_error_, error_); }

  /// Takes the explicit start values of a step, and adds their expected error if it is known.
  /// transport(out, X) sets out = U X U† with the U of the step before.
  template <class Transport>
  void add_expected(SplitMatrix& Omega, Transport&& transport) {
    explicit_[0] = 1.0 * Omega;
    is_of_this_step_ = true;
    if (!is_known_ || !(size_of_error_ > smallest * norm(Omega))) return;  // NaN included
    transport(transported_, error_[0]);
    add(Omega, transported_);
  }

  /// Records the Ω that solved the step.
  void record(const SplitMatrix& Omega) {
    is_known_ = is_of_this_step_;
    is_of_this_step_ = false;
    if (!is_known_) return;
    const auto solution = [&](std::size_t) -> const SplitMatrix& { return Omega; };
    size_of_error_ = form_residual(error_, solution, explicit_);
  }

 private:
  // Smallest part of Ω that E must be: rounding to single precision leaves 2e-7 to 4e-7 of Ω
  // unforetold.
  static constexpr double smallest = 1e-6;

  SplitStages explicit_;          // Ω⁰, one matrix
  bool is_of_this_step_ = false;  // false where the step started otherwise
  SingleStages error_;            // E of the last step, one matrix
  bool is_known_ = false;         // false where that started otherwise
  double size_of_error_ = 0.0;    // ‖E‖_F
  SingleMatrix transported_;
};

}  // namespace isosyrk
