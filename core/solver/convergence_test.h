// The convergence test of an iteration with corrections: when to stop, and how accurate residuals
// and corrections must be until then.
#pragma once

#include <optional>

#include "isosyrk/solver/acceptance.h"
#include "isosyrk/solver/corrections.h"
#include "isosyrk/solver/iteration_memory.h"

namespace isosyrk {

/// Judges the sweeps x <- x + δ of one iteration for x = G(x), where δ is R = G(x) - x (a Picard
/// sweep) or a correction of R.
///
/// At changes above Tuning::largest_corrected the Jacobian is a poor model, and Picard sweeps are
/// made.  From the first one on that does not contract, sweeps are those of a system for x far from
/// the solution: above h‖B‖ = 1.4 plain sweeps may grow before a correction can be computed.  If
/// these came in at a contraction of 0.7 already, algebra1 would take a quarter of its sweeps less
/// there, with the same products, and algebra2 and algebra3 up to 6 % more products at n = 129,
/// h = 0.1.
///
/// If the last observed contraction predicts that a few Picard sweeps
/// (Acceptance::sweeps_for_a_correction) will converge, no correction is computed.
///
/// In a sweep: begin_sweep(), a residual of accuracy(); judge(), and after_move() with the
/// correction, if one was asked for.
class ConvergenceTest {
 public:
  /// For n x n unknowns.  Picard sweeps contract by least_contraction or more than that: earlier
  /// steps may have shown less, where their errors had a symmetry.  The memory is that of earlier
  /// iterations, and learns of this one.
  ConvergenceTest(const Acceptance& rule, double tolerance, Index n, double least_contraction,
                  IterationMemory& memory);

  /// Begins a sweep.  The tolerance is relative to the unit; sizes below are not.
  void begin_sweep(double unit) { unit_ = unit; }

  /// Returns the accuracy of a residual: that of one which may be accepted.
  double accuracy() const { return unit_ * rule_.accepting_accuracy(tolerance_); }

  /// How x is moved.
  enum class Move {
    picard,      ///< by R
    far,         ///< by the far_sweep() of the system
    correction,  ///< by a correction, or by R if that is not usable
  };
  /// Judges a residual.
  Move judge(const ResidualSize& size);
  /// Returns the forcing term of a correction of this residual.
  double forcing_term() const;
  /// Is told how x was moved.
  void after_move(const Correction& correction);

  /// Returns the change of the sweep, relative to the unit.
  double change() const { return change_; }
  /// True if x, as moved, is accepted.
  bool accepts() const;

 private:
  void learn();
  void distrust();
  double first_factor() const;
  bool sweeps_alone_converge() const;

  Acceptance rule_;
  double tolerance_;
  int sweeps_for_a_correction_;
  double least_contraction_;
  IterationMemory& memory_;

  // Of the present sweep.  Changes are relative to the unit.
  double unit_ = 1.0;
  ResidualSize size_ = {};
  double change_ = 0.0;
  bool is_plain_ = false;  // Picard sweeps alone will converge
  bool is_far_ = false;    // from the solution
  double estimate_ = 0.0;  // of the error of x moved; NaN if unknown

  // Of the sweep before.
  bool is_first_ = true;
  double near_ = 0.0;       // its change if it was a Picard sweep near the solution, else 0
  double far_ = 0.0;        // its change if it was a Picard sweep far from it, else 0
  double corrected_ = 0.0;  // its change if it was corrected, else 0
  bool stalls_ = false;     // far from the solution Picard sweeps do not contract
};

}  // namespace isosyrk
