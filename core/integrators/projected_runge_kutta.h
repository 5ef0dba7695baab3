// The classical Runge-Kutta method with a projection onto the spectrum of the initial state.
#pragma once

#include "isosyrk/integrators/integrator.h"
#include "isosyrk/linalg/product_backend.h"
#include "isosyrk/linalg/spectral_projection.h"

namespace isosyrk {

/// A step of the classical Runge-Kutta method applied to W (ClassicalRungeKutta4), followed by
///
///     W = U (iΛ) U†  ->  U (iΛ₀) U†
///
/// with the eigenvalues Λ₀ of the state that the run began with.  A state that is set or amended
/// begins anew.  For flows with J = I.  Order 4, since the projection moves W by no more than twice
/// the error of the step.  Isospectral, not Lie-Poisson.  Unlike the Runge-Kutta step, the
/// projection changes the angular momentum.  Unstable where the Runge-Kutta method is.
/// Products: 7.  Poisson solves: 4.  Each step computes all eigenvectors of W, which costs some ten
/// products more and is not counted.
/// Source: projection methods in general, Hairer, Lubich and Wanner, Geometric Numerical
/// Integration, section IV.4.
class ProjectedRungeKutta4 final : public Integrator {
 public:
  /// Throws std::invalid_argument for a flow with another J than I.
  ProjectedRungeKutta4(const SharedFlow& flow, ProductBackend backend);

  double energy() const override { return flow().energy(W_); }

 private:
  void load(const ConstMatrixView& W) override;
  void amend(const ConstMatrixView& W) override { load(W); }
  StepReport advance_state(double h) override;
  void store(MatrixView W) const override { W = W_; }
  StepReport step_alone(MatrixView W, double h) override;

  StepReport step_from(const ConstMatrixView& W, const RealVector& eigenvalues, double h);

  std::unique_ptr<Integrator> method_;
  SpectralProjection projection_;
  bool is_real_;
  Matrix W_;  // the state of a run
  RealVector eigenvalues_;
  Matrix next_;
  RealVector eigenvalues_alone_;  // of a single step
};

}  // namespace isosyrk
