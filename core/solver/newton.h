// Inexact Newton iteration for x = G(x).
#pragma once

#include <optional>

#include "isosyrk/solver/fixed_point_system.h"

namespace isosyrk {

/// Inexact Newton: with R = G(x) - x, x moves by a correction delta that solves (1 - G') delta = R
/// to a forcing term.  Corrections are computed in single precision.  They reduce the residual, and
/// enter the acceptance test only where the system says so (Acceptance).
///
/// At changes above Tuning::largest_corrected Picard sweeps are made.  From the first one on that
/// does not contract, each is followed by a sweep with B frozen: above h‖B‖ = 1.4 plain sweeps may
/// grow before a correction can be computed.  If these came in at a contraction of 0.7 already,
/// algebra1 would take a quarter of its sweeps less there, with the same products, and algebra2 and
/// algebra3 up to 6 % more products at n = 129, h = 0.1.
///
/// If the last observed contraction predicts that a few Picard sweeps
/// (Acceptance::sweeps_for_a_correction) will converge, no correction is computed.
/// Source: R. S. Dembo, S. C. Eisenstat, T. Steihaug, SIAM J. Numer. Anal. 19, 1982.
class Newton {
 public:
  /// For unknowns of these shapes.  Only the constructor allocates.
  explicit Newton(const Unknowns& like);

  /// Solves from the given x, and returns how the iteration ended.
  SolveReport solve(FixedPointSystem& system, const IterationOptions& options, Unknowns& x);

  /// Returns the change of the first sweep of the last iteration, relative to the unit.
  double start_change() const { return start_change_; }

  /// What iterations have shown to later ones.
  struct Memory {
    double contraction = 0.0;   ///< last observed, of a Picard sweep near the solution
    double start_change = 0.0;  ///< of the first sweep of the last iteration; 0 if unknown
    /// Change after a correction, as a part of the change before; the last seen.
    std::optional<double> left_by_correction;
  };
  /// Exchanges what earlier iterations have shown with that of others.
  void exchange_memory(Memory& other);
  /// Forgets what earlier iterations have shown: the contraction, the error of start values, and
  /// that of corrections.
  void forget();

 private:
  void distrust();
  double first_factor() const;
  bool sweeps_alone_converge(int sweeps, double change, double tolerance) const;

  Index n_;
  Corrections R_, delta_;
  double contraction_ = 0.0;   // last observed, of a Picard sweep near the solution
  double start_change_ = 0.0;  // of the first sweep of the last iteration; 0 if unknown
  // Change after a correction, as a part of the change before; the last seen.
  std::optional<double> left_by_correction_;
};

}  // namespace isosyrk
