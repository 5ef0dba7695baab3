#include "isosyrk/fast/fast_integrator.h"

#include "isosyrk/split/parallel.h"

namespace isosyrk {

FastIntegrator::FastIntegrator(const Flow& flow, const MakeSystem& make_system,
                               const FastOptions& options, std::vector<double> fractions)
    : IntegratorIn(flow),
      threads_(ThreadScope::checked(options.threads)),
      fractions_(std::move(fractions)),
      W_(split_stages(static_cast<Index>(fractions_.size()) + 1, flow.size())) {
  for (std::size_t k = 0; k < fractions_.size(); ++k)
    substeps_.emplace_back(make_system(), options);
}

double FastIntegrator::change_of_one_more_sweep() {
  const ThreadScope scope(threads_);
  return substeps_.back().change_of_one_more_sweep(W_[W_.size() - 2], fractions_.back() * h_);
}

void FastIntegrator::forget() {
  for (FastSubstep& substep : substeps_) substep.forget();
}

StepReport FastIntegrator::work() const {
  StepReport total;
  for (const FastSubstep& substep : substeps_) total.append(substep.system().work());
  return total;
}

// Advances W_ by a step.  The report has all but the work.
StepReport FastIntegrator::take_substeps(double h) {
  StepReport total;
  for (std::size_t k = 0; k < substeps_.size(); ++k) {
    total.append(substeps_[k].advance(W_[k], fractions_[k] * h, W_[k + 1]));
    if (total.status != Status::converged) break;
  }
  return total;
}

StepReport FastIntegrator::advance(const Matrix& W0, double h, Matrix& W1) {
  const ThreadScope scope(threads_);
  const StepReport before = work();
  W_.front().load(W0);
  // Past steps predict only a step that continues from the last W₁.
  if (W_.front().entries() != W_.back().entries()) forget();
  h_ = h;
  StepReport report;
  try {
    report = take_substeps(h);
  } catch (...) {  // of SolverOptions::after_sweep
    forget();
    throw;
  }
  if (report.status == Status::converged) {
    W_.back().store(W1);
  } else {
    forget();
  }
  report.set_work(before, work());
  return report;
}

}  // namespace isosyrk
