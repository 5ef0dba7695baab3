// Any method, in the frame that rotates with the angular momentum.
#pragma once

#include <functional>

#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Solves V' = [B'(V), V] by another method, and turns V to W = e^{tR} V e^{-tR} where W is asked
/// for (flows/co_rotating_frame.h).  A run turns once, at its end, which its reports do not count.
/// Single steps from W each begin a frame of their own.
class FrameIntegrator final : public Integrator {
 public:
  using Make = std::function<std::unique_ptr<Integrator>(const SharedFlow&)>;

  /// Takes what makes the method for the flow of V.  Throws std::invalid_argument unless the flow
  /// is EulerZeitlin.
  FrameIntegrator(const SharedFlow& flow, const Make& make, ProductBackend backend);

  /// H is the same for W and V.
  double energy() const override;

 private:
  void load(const ConstMatrixView& W) override;
  void amend(const ConstMatrixView& W) override { load(W); }  // W begins a new frame
  StepReport advance_state(double h) override;
  void store(MatrixView W) const override;
  StepReport step_alone(MatrixView W, double h) override;

  // Workspace of store(), too.
  mutable CoRotatingFrame frame_;
  mutable Matrix V_;
  std::unique_ptr<Integrator> method_;
  CoRotatingFrame::Rate rate_{};
  // Time since the state was set: `past_` and then as many steps of one size.
  double past_ = 0.0;
  double h_ = 0.0;
  long steps_ = 0;
};

}  // namespace isosyrk
