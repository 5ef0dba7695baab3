#include "isosyrk/fast/split_integrator.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "isosyrk/split/parallel.h"

namespace isosyrk {
namespace {

// In x - x every number that is not finite gives NaN.
bool is_finite(const SplitMatrix& W) {
  std::array<double, parallel::most_blocks> zeros{};
  parallel::for_each_block(1, W.size(), [&](std::size_t, parallel::Rows rows, Index block) {
    const auto entries =
        W.entries().segment(W.stride() * rows.begin, W.stride() * (rows.end - rows.begin));
    zeros[static_cast<std::size_t>(block)] = (entries - entries).sum();
  });
  return std::ranges::all_of(zeros, [](double zero) { return zero == 0.0; });
}

}  // namespace

SplitIntegrator::SplitIntegrator(const SharedFlow& flow, int threads)
    : Integrator(flow),
      threads_(checked_threads(threads)),
      finder_(flow->size()),
      state_(flow->size()),
      other_state_(state_) {}

// Takes W as the state.
void SplitIntegrator::take(const ConstMatrixView& W, const StateScale& found) {
  state_.scale = found;
  auto load = [&] { state_.V[0].load(W); };
  on_threads(threads_, std::ref(load));
  if (found.value != 1.0) state_.V[0].entries() *= 1.0 / found.value;
}

void SplitIntegrator::load(const ConstMatrixView& W) {
  forget();
  take(W, finder_.find(W));
}

void SplitIntegrator::amend(const ConstMatrixView& W) {
  if (!ScaleFinder::changed_twofold(state_.scale, W)) {
    amended();
    return take(W, state_.scale);
  }
  forget();  // past steps are of another scale
  take(W, finder_.find(W));
}

void SplitIntegrator::store(MatrixView W) const {
  auto store = [&] { state_.V[0].store(W); };
  on_threads(threads_, std::ref(store));
  if (state_.scale.value != 1.0) W *= state_.scale.value;
}

Energy SplitIntegrator::energy() const {
  Matrix W(flow().size(), flow().size());
  store(W);
  return flow().energy(W);
}

StepReport SplitIntegrator::advance(double h, Past past) {
  const Work before = work();
  auto& [scale, V, next] = state_;
  StepReport report;
  auto step = [&] {
    report = take_step(next, V, scale.value * h, past);
    // Stages can converge and the update still overflow.
    if (report.status == Status::converged && !is_finite(next[0])) report.status = Status::diverged;
  };
  try {
    on_threads(threads_, std::ref(step));
  } catch (...) {  // of IterationOptions::after_sweep
    if (past == Past::used) forget();
    throw;
  }
  if (report.status == Status::converged) {
    next[0].set_band(next[0].size() - 1);
    V.swap(next);
  } else if (past == Past::used) {
    forget();
  }
  report.work = work() - before;
  return report;
}

StepReport SplitIntegrator::step_alone(MatrixView W, double h) {
  const Exchanged exchanged([&] {
    std::swap(state_, other_state_);
    exchange_memory();
  });
  take(W, finder_.find(W));
  const StepReport report = advance(h, Past::left_out);
  if (report.status == Status::converged) store(W);
  return report;
}

}  // namespace isosyrk
