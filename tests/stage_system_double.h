// A stage system to order: tests of what works with one say what it does, and count how often.
#pragma once

#include <algorithm>

#include "isosyrk/fast/stage_system.h"

namespace isosyrk::testing {

/// x = G(x) for one n x n unknown, of which x = W₀ is the solution: it is solved wherever it
/// starts.
class StageSystemDouble : public StageSystem {
 public:
  /// Calls since the step began.
  struct Calls {
    int cold_starts = 0;
    int residuals = 0;
    int linearisations = 0;
    int frozen_sweeps = 0;
    int couplings = 0;
    int updates = 0;
  };

  explicit StageSystemDouble(Index n) : n_(n) {}

  const Calls& calls() const { return calls_; }

  Unknowns unknowns() const override { return {split_stages(1, n_)}; }
  void bind(const SplitMatrix& W0, double, double) override {
    W0_ = &W0;
    calls_ = {};
  }
  void cold_start(Unknowns& x) override {
    ++calls_.cold_starts;
    x[0][0].entries().setZero();
  }
  double residual(Unknowns& x, double, Corrections& R) override {
    ++calls_.residuals;
    return residual_of(x[0][0], R[0][0]);
  }
  void linearise(double) override { ++calls_.linearisations; }
  double frozen_sweep(const Corrections& rhs, Corrections& delta) override {
    ++calls_.frozen_sweeps;
    const Eigen::VectorXf before = delta[0][0].entries();
    delta[0][0].entries() = rhs[0][0].entries() + T_ * before;
    return static_cast<double>((delta[0][0].entries() - before).norm());
  }
  void couple(const Corrections& delta, Corrections& coupled) override {
    ++calls_.couplings;
    coupled[0][0].entries() = K_ * delta[0][0].entries();
  }
  void update(const Unknowns& x, SplitMatrix& W1) override {
    ++calls_.updates;
    W1.entries() = x[0][0].entries();
  }
  bool truncates() const override { return false; }
  void truncate(bool) override {}
  StepReport work() const override { return {}; }

 protected:
  /// R = G(x) - x; returns the change of a Picard sweep.
  virtual double residual_of(const SplitMatrix& x, SingleMatrix& R) = 0;

  const SplitMatrix& W0() const { return *W0_; }

  /// What frozen sweeps and couplings multiply corrections by.
  float T_ = 0.0f, K_ = 0.0f;
  Calls calls_;

 private:
  Index n_;
  const SplitMatrix* W0_ = nullptr;
};

}  // namespace isosyrk::testing
