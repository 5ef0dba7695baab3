// Any method, in the frame that rotates with the angular momentum.
#pragma once

#include <functional>

#include "isosyrk/flows/co_rotating_frame.h"
#include "isosyrk/integrators/integrator.h"

namespace isosyrk {

/// Solves V' = [B'(V), V] by another method, and turns V to W = e^{tR} V e^{-tR} where W is asked
/// for (flows/co_rotating_frame.h).  A run turns once, at its end, which its reports do not count.
/// In parts it goes on in the same frame, turned by its time since the run began.  Single steps
/// from W each begin a frame of their own.
///
/// If W is amended, the frame goes on from where it is, with the rate of the new W: V then changes
/// as little as W does, and past steps predict.
class FrameIntegrator final : public Integrator {
 public:
  using Make = std::function<std::unique_ptr<Integrator>(const SharedFlow&)>;

  /// Takes what makes the method for the flow of V, and the threads that turn it.  Throws
  /// std::invalid_argument unless the flow is EulerZeitlin, and as checked_threads.
  FrameIntegrator(const SharedFlow& flow, const Make& make, int threads = 1);

  /// H is the same for W and V.
  Energy energy() const override;

 private:
  void load(const ConstMatrixView& W) override;
  void amend(const ConstMatrixView& W) override;
  StepReport advance_state(double h) override;
  void store(MatrixView W) const override;
  StepReport step_alone(MatrixView W, double h) override;
  void archive_run(StateArchive& run) override;
  SpinRotation turned() const;

  // Workspace of store(), too.
  mutable CoRotatingFrame frame_;
  mutable Matrix V_;
  std::unique_ptr<Integrator> method_;
  // W = e^{tR} U V U† e^{-tR}, where U is how far the frame had turned when the state was amended.
  SpinRotation U_;
  CoRotatingFrame::Rate rate_{};
  // Time since the state was set or amended: `past_` and then as many steps of one size.
  double past_ = 0.0;
  double h_ = 0.0;
  long steps_ = 0;
};

}  // namespace isosyrk
