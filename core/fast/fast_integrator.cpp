#include "isosyrk/fast/fast_integrator.h"

#include <utility>

#include "isosyrk/split/parallel.h"

namespace isosyrk {

FastIntegrator::FastIntegrator(const SharedFlow& flow, const MakeSystem& make_system,
                               const FastOptions& options, std::vector<double> fractions)
    : SplitIntegrator(flow, options.threads), fractions_(std::move(fractions)) {
  for (std::size_t k = 0; k < fractions_.size(); ++k)
    substeps_.emplace_back(make_system(), options);
  remember(empty_memory(true), empty_memory(false));
}

std::unique_ptr<FastIntegrator::Memory> FastIntegrator::empty_memory(bool of_run) const {
  auto memory = std::make_unique<Memory>();
  for (const FastSubstep& substep : substeps_) {
    memory->of_substeps.push_back(of_run ? substep.memory_of_run() : substep.memory_beside());
  }
  memory->between = split_stages(static_cast<Index>(fractions_.size()) - 1, flow().size());
  return memory;
}

void FastIntegrator::Memory::forget() {
  for (SubstepMemory& each : of_substeps) each.forget();
}

double FastIntegrator::change_of_one_more_sweep() {
  auto& of_run = memory_of_run<Memory>();
  const SplitMatrix& W0 = of_run.between.empty() ? before_last_step() : of_run.between.back();
  double change = 0.0;
  on_threads(threads(), [&] {
    change = substeps_.back().change_of_one_more_sweep(W0, fractions_.back() * of_run.h,
                                                       of_run.of_substeps.back(),
                                                       memory_beside<Memory>().of_substeps.back());
  });
  return change;
}

Work FastIntegrator::work() const {
  Work total;
  for (const FastSubstep& substep : substeps_) total += substep.system().work();
  return total;
}

void FastIntegrator::archive_work(StateArchive& run) {
  for (FastSubstep& substep : substeps_) substep.archive_work(run);
}

StepReport FastIntegrator::take_step(SplitStages& W1, const SplitStages& W0, double h,
                                     StepMemory& of_steps) {
  auto& memory = static_cast<Memory&>(of_steps);
  memory.h = h;
  StepReport total;
  const SplitMatrix* from = &W0[0];
  for (std::size_t k = 0; k < substeps_.size(); ++k) {
    SplitMatrix& to = k < memory.between.size() ? memory.between[k] : W1[0];
    total.append(substeps_[k].advance(to, *from, fractions_[k] * h, memory.of_substeps[k]));
    if (total.status != Status::converged) break;
    from = &to;
  }
  return total;
}

}  // namespace isosyrk
