#include "isosyrk/fast/split_integrator.h"

#include <algorithm>
#include <array>
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
  on_threads(threads_, [&] { run_.V[0].load(W); });
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

void SplitIntegrator::archive_run(StateArchive& run) {
  run.pass(run_.scale, run_.V[0], *run_.memory);
  archive_work(run);
}

void SplitIntegrator::store(MatrixView W) const {
  on_threads(threads_, [&] { run_.V[0].store(W); });
  if (run_.scale.value != 1.0) W *= run_.scale.value;
}

Energy SplitIntegrator::energy() const {
  Matrix W(flow().size(), flow().size());
  store(W);
  return flow().energy(W);
}

StepReport SplitIntegrator::advance(double h) {
  const Work before = work();
  StepReport report;
  try {
    on_threads(threads_, [&] {
      report = take_step(run_.next, run_.V, run_.scale.value * h, *run_.memory);
      // Stages can converge and the update still overflow.
      if (report.status == Status::converged && !is_finite(run_.next[0])) {
        report.status = Status::diverged;
      }
    });
  } catch (...) {  // of IterationOptions::after_sweep
    run_.memory->forget();
    throw;
  }
  if (report.status == Status::converged) {
    run_.next[0].set_band(run_.next[0].size() - 1);
    run_.V.swap(run_.next);
  } else {
    run_.memory->forget();
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
