#include "isosyrk/fast/split_integrator.h"

#include <utility>

#include "isosyrk/split/parallel.h"

namespace isosyrk {
namespace {

// In x - x every number that is not finite gives NaN.
bool is_finite(const SplitMatrix& W) { return (W.entries() - W.entries()).sum() == 0.0; }

}  // namespace

SplitIntegrator::SplitIntegrator(const SharedFlow& flow, int threads)
    : Integrator(flow),
      threads_(ThreadScope::checked(threads)),
      state_(split_stages(1, flow->size())),
      next_(state_) {}

// Past steps predict only a step that continues from where they ended.
void SplitIntegrator::load(const ConstMatrixView& W) {
  next_[0].load(W);
  if (next_[0].entries() == state_[0].entries()) return;
  forget();
  state_.swap(next_);
}

StepReport SplitIntegrator::advance(double h, Past past) {
  const ThreadScope scope(threads_);
  const StepReport before = work();
  StepReport report;
  try {
    report = take_step(state_, h, past, next_);
  } catch (...) {  // of SolverOptions::after_sweep
    if (past == Past::used) forget();
    throw;
  }
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !is_finite(next_[0])) report.status = Status::diverged;
  if (report.status == Status::converged) {
    next_[0].set_band(next_[0].size() - 1);
    state_.swap(next_);
  } else if (past == Past::used) {
    forget();
  }
  report.set_work(before, work());
  return report;
}

// Exchanges the state with W.
void SplitIntegrator::exchange(MatrixView W) {
  next_[0].load(W);
  state_[0].store(W);
  state_.swap(next_);
}

// W keeps the state of a run meanwhile, as in IntegratorIn.
StepReport SplitIntegrator::step_alone(MatrixView W, double h) {
  const Exchanged exchanged([&] { exchange(W); });
  return advance(h, Past::left_out);
}

}  // namespace isosyrk
