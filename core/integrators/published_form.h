// What the published forms share: products, evaluations of B, the count of both, and the iteration.
#pragma once

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/iteration/picard.h"
#include "isosyrk/linalg/operations.h"
#include "isosyrk/linalg/products.h"

namespace isosyrk {

/// An integrator that reports the products and the evaluations of B of each step.
class PublishedForm : public Integrator {
 protected:
  PublishedForm(const Flow& flow, ProductBackend backend)
      : Integrator(flow), products_(backend, flow.size()) {}

  /// Computes W1 from W0.  The report has all but the work.
  virtual StepReport take_step(const Matrix& W0, double h, Matrix& W1) = 0;

  /// B = B(W), as Flow::generator; counted.
  void generator(const Matrix& W, Matrix& B) {
    flow().generator(W, B);
    ++poisson_solves_;
  }

  Products products_;

 private:
  StepReport advance(const Matrix& W0, double h, Matrix& W1) final {
    const long products_before = products_.count();
    const long solves_before = poisson_solves_;
    StepReport report = take_step(W0, h, W1);
    report.products = products_.count() - products_before;
    report.poisson_solves = poisson_solves_ - solves_before;
    report.equivalent_products = static_cast<double>(report.products);
    return report;
  }

  long poisson_solves_ = 0;
};

/// A published form with unknowns: Picard sweeps from a cold start, then the update.
class ImplicitForm : public PublishedForm {
 protected:
  ImplicitForm(const Flow& flow, const SolverOptions& options, ProductBackend backend)
      : PublishedForm(flow, backend), options_(options) {}

  /// Sets the unknowns to those of a cold start.
  virtual void start(const Matrix& W0) = 0;
  /// Makes a Picard sweep, as in solve_fixed_point.
  virtual double sweep(const Matrix& W0, double h) = 0;
  /// Computes W1 from the accepted unknowns.
  virtual void update(const Matrix& W0, double h, Matrix& W1) = 0;

 private:
  StepReport take_step(const Matrix& W0, double h, Matrix& W1) final {
    start(W0);
    const SolveReport solve = solve_fixed_point(options_, [&] { return sweep(W0, h); });
    if (solve.status == Status::converged) update(W0, h, W1);
    return {.status = solve.status,
            .attempt = {Start::cold, Iteration::picard},
            .sweeps = solve.sweeps,
            .last_change = solve.change,
            .contraction = solve.contraction};
  }

  SolverOptions options_;
};

}  // namespace isosyrk
