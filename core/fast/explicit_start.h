// The explicit start values of the exponential Lie-Poisson methods.
#pragma once

#include "isosyrk/fast/exponential_step.h"
#include "isosyrk/fast/exponential_update.h"
#include "isosyrk/fast/split_operations.h"
#include "isosyrk/integrators/magnus_exponent.h"

namespace isosyrk {

/// Ω ≈ Ω⁰ + E, where Ω⁰ is the exponent of an explicit Magnus method, magnus4 or, for order 6,
/// magnus5 (integrators/explicit_magnus.h), and E the error that it is expected to have, foretold
/// from that of the step before (StartError).  In single precision.
///
/// Products: 6 for magnus4, 12 for magnus5, and 1.5 for E.  Poisson solves: 7 or 12.
class ExplicitStart {
 public:
  /// For methods of order 2, 4 or 6.  All that is taken must outlive it.  Only the constructor
  /// allocates.
  ExplicitStart(SplitOperations& operations, const ExponentialStep& step, ExponentialUpdate& update,
                int order);

  /// Sets Ω.  Returns false, with Ω unspecified, where the rounding of a rotation that is left out
  /// of B would be a large part of it.
  bool form(SplitMatrix& Omega);
  /// Records the Ω that solved the step, however it was started.
  void learn(const SplitMatrix& Omega) { step_.memory->start_error.record(Omega); }

 private:
  SplitLie<float>& lie_;
  const ExponentialStep& step_;
  ExponentialUpdate& update_;
  MagnusExponent<SplitLie<float>> magnus_;
  SingleMatrix Omega_;  // Ω⁰
};

}  // namespace isosyrk
