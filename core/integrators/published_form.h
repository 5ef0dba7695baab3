// What the published forms share: products, evaluations of B, the count of both, and the iteration.
#pragma once

#include <vector>

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/integrators/stage_equations.h"
#include "isosyrk/iteration/picard.h"
#include "isosyrk/linalg/operations.h"
#include "isosyrk/linalg/products.h"

namespace isosyrk {

/// An integrator that reports the products and the evaluations of B of each step.  Written once for
/// real and complex, dense and block diagonal matrices: it sees them in storage only.
template <class Scalar>
class PublishedForm : public IntegratorIn<Scalar> {
 public:
  using Stored = MatrixOf<Scalar>;
  using Stages = std::vector<Stored>;

 protected:
  PublishedForm(SharedFlowIn<Scalar> flow, ProductBackend backend)
      : IntegratorIn<Scalar>(std::move(flow)),
        products_(backend, this->flow().size(), algebra().block()) {}

  /// Computes W1 from W0.  The report has all but the work.
  virtual StepReport take_step(const Stored& W0, double h, Stored& W1) = 0;

  /// B = B(W), counted.
  void generator(const Stored& W, Stored& B) {
    this->evaluate(W, B);
    ++poisson_solves_;
  }

  const QuadraticAlgebra& algebra() const { return this->flow().algebra(); }
  /// Returns the zero matrix, s of them, or the identity, in storage.
  Stored zero() const { return algebra().template zero<Scalar>(); }
  Stages zeros(Index s) const { return Stages(static_cast<std::size_t>(s), zero()); }
  Stored identity() const { return algebra().template identity<Scalar>(); }
  /// Returns scratch for what J does to a matrix; empty if J = I.
  Stored scratch_of_J() const { return algebra().is_skew_hermitian() ? Stored() : zero(); }

  ProductsOf<Scalar> products_;

 private:
  StepReport advance(const Stored& W0, double h, Stored& W1) final {
    const Work before = work();
    StepReport report = take_step(W0, h, W1);
    report.work = work() - before;
    return report;
  }

  // Since construction.
  Work work() const {
    const long products = products_.count();
    return {.products = products,
            .equivalent_products = static_cast<double>(products),
            .poisson_solves = poisson_solves_};
  }

  long poisson_solves_ = 0;
};

/// A published form with unknowns: Picard sweeps from a cold start, then the update.
template <class Scalar>
class ImplicitForm : public PublishedForm<Scalar> {
 public:
  using typename PublishedForm<Scalar>::Stored;

 protected:
  ImplicitForm(SharedFlowIn<Scalar> flow, const IterationOptions& options, ProductBackend backend)
      : PublishedForm<Scalar>(std::move(flow), backend), options_(options) {}

  /// Sets the unknowns to those of a cold start.
  virtual void start(const Stored& W0) = 0;
  /// Makes a Picard sweep, as in solve_fixed_point.
  virtual double sweep(const Stored& W0, double h) = 0;
  /// Computes W1 from the accepted unknowns.
  virtual void update(const Stored& W0, double h, Stored& W1) = 0;

 private:
  StepReport take_step(const Stored& W0, double h, Stored& W1) final {
    start(W0);
    const SolveReport solve = solve_fixed_point(options_, [&] { return sweep(W0, h); });
    if (solve.status == Status::converged) update(W0, h, W1);
    return {.status = solve.status,
            .attempt = {Start::cold, Iteration::picard},
            .sweeps = solve.sweeps,
            .last_change = solve.change,
            .contraction = solve.contraction};
  }

  IterationOptions options_;
};

}  // namespace isosyrk
