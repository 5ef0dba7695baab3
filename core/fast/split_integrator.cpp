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
      finder_(flow->size()),
      state_(split_stages(1, flow->size())),
      next_(state_) {}

// Takes the W in next_ as the state.
void SplitIntegrator::take(const StateScale& found) {
  scale_ = found;
  if (scale_.value != 1.0) next_[0].entries() *= 1.0 / scale_.value;
  state_.swap(next_);
}

// Past steps predict only a step that continues from where they ended.
void SplitIntegrator::load(const ConstMatrixView& W) {
  next_[0].load(W);
  if (next_[0].entries() == scale_.value * state_[0].entries()) return;
  forget();
  take(finder_.find(W));
}

void SplitIntegrator::amend(const ConstMatrixView& W) {
  next_[0].load(W);
  if (!ScaleFinder::changed_twofold(scale_, W)) return take(scale_);
  forget();  // past steps are of another scale
  take(finder_.find(W));
}

void SplitIntegrator::store(MatrixView W) const {
  state_[0].store(W);
  if (scale_.value != 1.0) W *= scale_.value;
}

StepReport SplitIntegrator::advance(double h, Past past) {
  const ThreadScope scope(threads_);
  const Work before = work();
  StepReport report;
  try {
    report = take_step(next_, state_, scale_.value * h, past);
  } catch (...) {  // of IterationOptions::after_sweep
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
  report.work = work() - before;
  return report;
}

// Exchanges the state with W.
void SplitIntegrator::exchange(MatrixView W, const StateScale& of_W) {
  next_[0].load(W);
  store(W);
  take(of_W);
}

// W keeps the state of a run meanwhile, as in IntegratorIn.
StepReport SplitIntegrator::step_alone(MatrixView W, double h) {
  StateScale other = finder_.find(W);
  const Exchanged exchanged([&] {
    const StateScale mine = scale_;
    exchange(W, other);
    other = mine;
  });
  return advance(h, Past::left_out);
}

}  // namespace isosyrk
