// The contract of a one-step method.
#pragma once

#include "isosyrk/flows/flow.h"
#include "isosyrk/iteration/status.h"

namespace isosyrk {

/// What one step did.
struct StepReport {
  Status status = Status::converged;
  Attempt attempt = {};  ///< the attempt that the status is of: the last one made
  int sweeps = 0;        ///< of all attempts; 0 for explicit methods
  double last_change = 0.0;
  double contraction = 0.0;  ///< of the iteration, as in SolveReport; 0 for explicit methods
  long products = 0;         ///< n x n complex matrix products
  long poisson_solves = 0;   ///< evaluations of the generator B
  /// The work of the products in full ones: a product of which half is formed counts as half.
  double equivalent_products = 0.0;
};

/// A one-step method W₀ -> W₁ with its workspace.  The flow must outlive it.
class Integrator {
 public:
  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Advances W, n x n, by h, which may be negative, and reports what that took.  Unless the status
  /// is `converged`, W is left as it was.  Memory stays the caller's: W is read and written where
  /// it is.  Allocates nothing.  Throws std::invalid_argument for a W of another size or an h that
  /// is not finite.
  StepReport step(MatrixView W, double h);

  const Flow& flow() const { return flow_; }

  /// The n x n complex matrices that every integrator holds, beside those of its form.
  static constexpr Index common_matrices = 2;

 protected:
  explicit Integrator(const Flow& flow);

  /// Computes W1 from W0, both n x n; the contents of W1 count only when the status is `converged`.
  virtual StepReport advance(const Matrix& W0, double h, Matrix& W1) = 0;

 private:
  const Flow& flow_;
  Matrix W0_;
  Matrix W1_;
};

}  // namespace isosyrk
