// Counters for the work of a published form: evaluations of B and products.
#pragma once

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/linalg/products.h"

namespace isosyrk {

/// A flow whose evaluations of B are counted.  The flow must outlive the CountedFlow.
class CountedFlow {
 public:
  explicit CountedFlow(const Flow& flow) : flow_(flow) {}

  /// B = B(W), as Flow::generator.
  void generator(const Matrix& W, Matrix& B) {
    flow_.generator(W, B);
    ++poisson_solves_;
  }

  const QuadraticAlgebra& algebra() const { return flow_.algebra(); }
  /// Returns the number of evaluations of B since construction.
  long poisson_solves() const { return poisson_solves_; }

 private:
  const Flow& flow_;
  long poisson_solves_ = 0;
};

/// Counts the work of one step, from the construction of the StepCount on.
class StepCount {
 public:
  StepCount(const CountedFlow& flow, const Products& products)
      : flow_(flow),
        products_(products),
        solves_before_(flow.poisson_solves()),
        products_before_(products.count()) {}

  /// Returns the report of a step with Picard sweeps from a cold start.
  StepReport report(const SolveReport& solve) const {
    return report(solve, {Start::cold, Iteration::picard});
  }
  /// Returns the report of an explicit step.
  StepReport report(Status status) const { return report({.status = status}, Attempt{}); }

 private:
  StepReport report(const SolveReport& solve, Attempt attempt) const {
    const long products = products_.count() - products_before_;
    return {.status = solve.status,
            .attempt = attempt,
            .sweeps = solve.sweeps,
            .last_change = solve.change,
            .contraction = solve.contraction,
            .products = products,
            .poisson_solves = flow_.poisson_solves() - solves_before_,
            .equivalent_products = static_cast<double>(products)};
  }

  const CountedFlow& flow_;
  const Products& products_;
  long solves_before_;
  long products_before_;
};

}  // namespace isosyrk
