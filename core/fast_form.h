// What the fast forms share: planar storage, start values from earlier steps, and a restart.
#pragma once

#include <initializer_list>
#include <optional>
#include <vector>

#include "core/anderson.h"
#include "core/integrator.h"
#include "core/planar_laplacian.h"
#include "core/planar_products.h"
#include "core/start_values.h"

namespace isosyrk {

class EulerZeitlin;

struct FastOptions {
  SolverOptions solver;
  /// Past steps that start values are extrapolated from; 0: every step starts cold.
  int start_order = 8;
  /// Whether sweeps are accelerated (Anderson).  By default with one stage and n >= 32, where it
  /// pays: with more stages it saves a twentieth of the sweeps, for more than that of their time.
  std::optional<bool> accelerate = {};
};

/// A one-step method in planar matrices for Euler-Zeitlin on su(n): the answer of the published
/// form to the solver's tolerance, sooner.
///
/// Every iteration starts from extrapolated unknowns and stops by the rule of fixed_point.h, on the
/// change that a plain sweep makes, so that what is accepted is as good as from a cold start. Where
/// it fails from there it is tried once more cold, and only then has the step failed.  After a
/// failed step, for a step of another size, and from another state than the last step ended at, it
/// starts cold.
class FastForm : public Integrator {
 public:
  /// Planar products so far, and those of them that formed a triangle.
  const PlanarProducts& planar_products() const { return planar_; }

  /// The change that one more sweep makes to the unknowns with which the last step, of size h, was
  /// accepted: what the tolerance bounds, seen from outside the solver.
  double change_of_one_more_sweep(double h);

 protected:
  /// With so many unknowns of each kind.
  FastForm(const EulerZeitlin& flow, const FastOptions& options,
           std::initializer_list<Index> unknowns);

  SolveReport advance(const Matrix& W0, double h, Matrix& W1) final;

  /// Sets the unknowns for a cold start.
  virtual void start_cold() = 0;
  /// Computes what follows from the unknowns where it is not the last sweep that set them.
  virtual void begin() {}
  /// As of solve_fixed_point.
  virtual double sweep(double h) = 0;
  /// W₁ from the last sweep.
  virtual void update(double h, PlanarMatrix& W1) = 0;

  /// B = B(W), counted; of W the upper triangle is read.
  void generator(const PlanarMatrix& W, PlanarMatrix& B);

  PlanarMatrix zero() const { return PlanarMatrix(W0_.size()); }
  PlanarMatrix identity() const;
  std::vector<PlanarMatrix> zeros(Index count) const {
    return std::vector<PlanarMatrix>(static_cast<std::size_t>(count), zero());
  }

  PlanarProducts planar_;
  PlanarMatrix W0_;
  Unknowns unknowns_;

 private:
  SolveReport iterate(double h);

  FastOptions options_;
  PlanarLaplacian laplacian_;
  double reciprocal_hbar_;
  PlanarMatrix W1_;
  StartValues start_values_;
  Anderson anderson_;
  bool accelerates_;
  long solves_ = 0;
};

}  // namespace isosyrk
