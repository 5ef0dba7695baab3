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
      run_(flow->size()),
      beside_(flow->size()) {}

void SplitIntegrator::remember(std::unique_ptr<StepMemory> of_run,
                               std::unique_ptr<StepMemory> beside) {
  run_.memory = std::move(of_run);
  beside_.memory = std::move(beside);
}

// Takes W as the state.
void SplitIntegrator::take(const ConstMatrixView& W, const StateScale& found) {
  run_.scale = found;
  run_.V[0].load(W);
  if (found.value != 1.0) run_.V[0].entries() *= 1.0 / found.value;
}

void SplitIntegrator::load(const ConstMatrixView& W) {
  run_.memory->forget();
  take(W, finder_.find(W));
}

void SplitIntegrator::amend(const ConstMatrixView& W) {
  if (!ScaleFinder::changed_twofold(run_.scale, W)) {
    amended();
    return take(W, run_.scale);
  }
  run_.memory->forget();  // past steps are of another scale
  take(W, finder_.find(W));
}

void SplitIntegrator::store(MatrixView W) const {
  run_.V[0].store(W);
  if (run_.scale.value != 1.0) W *= run_.scale.value;
}

Energy SplitIntegrator::energy() const {
  Matrix W(flow().size(), flow().size());
  store(W);
  return flow().energy(W);
}

StepReport SplitIntegrator::advance(double h) {
  const ThreadScope scope(threads_);
  const Work before = work();
  auto& [scale, V, next, memory] = run_;
  StepReport report;
  try {
    report = take_step(next, V, scale.value * h, *memory);
  } catch (...) {  // of IterationOptions::after_sweep
    memory->forget();
    throw;
  }
  // Stages can converge and the update still overflow.
  if (report.status == Status::converged && !is_finite(next[0])) report.status = Status::diverged;
  if (report.status == Status::converged) {
    next[0].set_band(next[0].size() - 1);
    V.swap(next);
  } else {
    memory->forget();
  }
  report.work = work() - before;
  return report;
}

StepReport SplitIntegrator::step_alone(MatrixView W, double h) {
  const Exchanged exchanged([&] { std::swap(run_, beside_); });
  load(W);
  const StepReport report = advance(h);
  if (report.status == Status::converged) store(W);
  return report;
}

}  // namespace isosyrk
