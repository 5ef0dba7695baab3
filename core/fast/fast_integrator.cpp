#include "isosyrk/fast/fast_integrator.h"

#include <utility>

#include "isosyrk/split/parallel.h"

namespace isosyrk {

FastIntegrator::FastIntegrator(const SharedFlow& flow, const MakeSystem& make_system,
                               const FastOptions& options, std::vector<double> fractions)
    : SplitIntegrator(flow, options.threads),
      fractions_(std::move(fractions)),
      between_(split_stages(static_cast<Index>(fractions_.size()) - 1, flow->size())),
      other_between_(between_) {
  for (std::size_t k = 0; k < fractions_.size(); ++k)
    substeps_.emplace_back(make_system(), options);
}

double FastIntegrator::change_of_one_more_sweep() {
  const SplitMatrix& W0 = between_.empty() ? before_last_step() : between_.back();
  double change = 0.0;
  on_threads(threads(), [&] {
    change = substeps_.back().change_of_one_more_sweep(W0, fractions_.back() * h_);
  });
  return change;
}

void FastIntegrator::forget() {
  for (FastSubstep& substep : substeps_) substep.forget();
}

void FastIntegrator::exchange_memory() {
  for (FastSubstep& substep : substeps_) substep.exchange_memory();
  between_.swap(other_between_);
  std::swap(h_, other_h_);
}

Work FastIntegrator::work() const {
  Work total;
  for (const FastSubstep& substep : substeps_) total += substep.system().work();
  return total;
}

StepReport FastIntegrator::take_step(SplitStages& W1, const SplitStages& W0, double h, Past past) {
  h_ = h;
  StepReport total;
  const SplitMatrix* from = &W0[0];
  for (std::size_t k = 0; k < substeps_.size(); ++k) {
    SplitMatrix& to = k < between_.size() ? between_[k] : W1[0];
    total.append(substeps_[k].advance(to, *from, fractions_[k] * h, past));
    if (total.status != Status::converged) break;
    from = &to;
  }
  return total;
}

}  // namespace isosyrk
