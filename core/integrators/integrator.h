// One-step integrators of isospectral flows.
#pragma once

#include <string>

#include "isosyrk/iteration/status.h"
#include "isosyrk/flows/flow.h"
#include "isosyrk/linalg/products.h"

namespace isosyrk {

/// What one step did.
struct StepReport {
  Status status = Status::converged;
  int sweeps = 0;  ///< 0 for explicit methods
  double last_change = 0.0;
  double contraction = 0.0;  ///< of the iteration, as in SolveReport; 0 for explicit methods
  long products = 0;         ///< n x n complex matrix products
  long poisson_solves = 0;   ///< evaluations of the generator B
  /// What the products come to in full ones: of a triangle, half is formed.
  double equivalent_products = 0.0;
};

/// A one-step method W₀ -> W₁ with its workspace.  The flow must outlive it.
class Integrator {
 public:
  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Advances W, n x n, by h (which may be negative).  Unless the status is `converged`, W is left
  /// as it was.  Allocates nothing.  Throws std::invalid_argument for a W of another size or an h
  /// that is not finite.
  StepReport step(Matrix& W, double h);

  const Flow& flow() const { return flow_; }

 protected:
  Integrator(const Flow& flow, ProductBackend backend);

  /// Computes W1 from W0; the contents of W1 count only when the status is `converged`.
  virtual SolveReport advance(const Matrix& W0, double h, Matrix& W1) = 0;

  /// B = B(W), counted.
  void generator(const Matrix& W, Matrix& B) {
    flow_.generator(W, B);
    ++poisson_solves_;
  }

  /// Counts the work of a step of another integrator that this one is made of.
  void add_work(const StepReport& inner) {
    inner_products_ += inner.products;
    inner_equivalents_ += inner.equivalent_products;
    poisson_solves_ += inner.poisson_solves;
  }

  const Flow& flow_;
  Products products_;

 private:
  long products() const { return products_.count() + inner_products_; }

  double equivalents() const { return static_cast<double>(products_.count()) + inner_equivalents_; }

  long inner_products_ = 0;
  double inner_equivalents_ = 0.0;
  long poisson_solves_ = 0;
  Matrix next_;
};

}  // namespace isosyrk
