// Any method, in the frame that rotates with the angular momentum.
#pragma once

#include <functional>

#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Solves V' = [B'(V), V] by another method, and turns V to W = e^{tR} V e^{-tR} where W is asked
/// for (flows/co_rotating_frame.h).  A run turns once, at its end, which its reports do not count.
/// Single steps from W each begin a frame of their own, with no past steps to predict from.
class FrameIntegrator final : public Integrator {
 public:
  using Make = std::function<std::unique_ptr<Integrator>(const Flow&)>;

  /// Takes what makes the method for the flow of V.  Throws std::invalid_argument unless the flow
  /// is EulerZeitlin.
  FrameIntegrator(const Flow& flow, const Make& make, ProductBackend backend);

  StepReport advance(const Matrix& V0, double h, Matrix& V1) override {
    return method_->advance(V0, h, V1);
  }

 protected:
  void enter(const Matrix& W0) override { frame_.set(W0); }
  void leave(double t, const Matrix& V, MatrixView W) override { frame_.leave(t, V, W); }

 private:
  CoRotatingFrame frame_;
  std::unique_ptr<Integrator> method_;
};

}  // namespace isosyrk
