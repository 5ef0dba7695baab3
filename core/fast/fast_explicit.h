// Explicit methods in split-complex storage.
#pragma once

#include <array>

#include "isosyrk/fast/split_integrator.h"
#include "isosyrk/fast/split_workspace.h"

namespace isosyrk {

/// What the explicit methods share: their operations in split-complex storage, for J = I.
class FastExplicit : public SplitIntegrator {
 protected:
  /// Throws std::invalid_argument for a flow without a generator in split-complex storage, and for
  /// threads out of range.  Bands are truncated if options.bands is true.
  FastExplicit(const SharedFlow& flow, const FastOptions& options);

  /// Computes W1 from W0.  Returns false if the step diverges.
  virtual bool steps(const SplitStages& W0, double h, SplitStages& W1) = 0;

  /// out = scale [A, X] for skew-Hermitian A and X, by one product.
  void commutator(const SplitMatrix& A, const SplitMatrix& X, double scale, SplitStages& out);
  /// B = B(W).  W is cut to its band.
  void generate(SplitStages& W, SplitStages& B);

  SplitWorkspace work_;
  SplitStages W_stage_;

 private:
  StepReport take_step(const SplitStages& W0, double h, Past, SplitStages& W1) final;
  StepReport work() const final { return work_.work(); }

  double tolerance_;
  SplitStages product_;
};

/// ClassicalRungeKutta4 to rounding.  Products: 4.  Poisson solves: 4.
class FastRungeKutta4 final : public FastExplicit {
 public:
  FastRungeKutta4(const SharedFlow& flow, const FastOptions& options);

 private:
  bool steps(const SplitStages& W0, double h, SplitStages& W1) override;

  SplitStages B_;
  std::array<SplitStages, 4> k_;
};

/// MuntheKaas4 to rounding.  Terms of a series below Tuning::single_term are summed in single
/// precision.  Products: 2, and 1 for each term of the 4 series.  Poisson solves: 4.
class FastMuntheKaas4 final : public FastExplicit {
 public:
  FastMuntheKaas4(const SharedFlow& flow, const FastOptions& options);

 private:
  bool steps(const SplitStages& W0, double h, SplitStages& W1) override;
  // out = e^A W e^(-A) with A = scale Omega; false if the series does not converge.
  bool conjugate(double scale, const SplitStages& Omega, const SplitStages& W, SplitStages& out);

  std::array<SplitStages, 4> k_;
  SplitStages Omega_, commutator_, term_, next_;
  SingleStages Omega_single_, term_single_, next_single_, product_single_;
};

}  // namespace isosyrk
