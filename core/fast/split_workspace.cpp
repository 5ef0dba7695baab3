#include "isosyrk/fast/split_workspace.h"

#include <algorithm>
#include <stdexcept>

#include "isosyrk/split/skew.h"

namespace isosyrk {

SplitWorkspace::SplitWorkspace(const Flow& flow, int threads, bool truncates, Index matrices,
                               const Tuning::CouplingBand& coupling_band)
    : products(flow.size(), threads),
      single_products(flow.size(), threads),
      bands(truncates, static_cast<std::size_t>(matrices), flow.size()),
      generator_(flow.split_generator()) {
  if (generator_ == nullptr) {
    throw std::invalid_argument(
        "solver fast: fast forms are for Euler-Zeitlin; this flow has no generator in split "
        "storage "
        "(published forms need none)");
  }
  const Index n = flow.size();
  least_coupling_band_ =
      generator_->damps_fine_scales() ? std::min(coupling_band(n), n - 1) : n - 1;
}

SplitMatrix SplitWorkspace::identity() const {
  SplitMatrix I = zero();
  for (Index i = 0; i < I.size(); ++i) I.re()[i * I.stride() + i] = 1.0;
  I.set_band(0);
  return I;
}

void SplitWorkspace::begin_step(double h, double tolerance) {
  h_ = std::abs(h);
  left_out_ = tuning.left_out * tolerance;
}

void SplitWorkspace::generate(const SplitStages& W, SplitStages& B) {
  generator_->upper(W, B);
  solves_ += static_cast<long>(W.size());
  bands.truncate_skew(left_out_ / h_, B);
}

void SplitWorkspace::round_generators(double accuracy, const SplitStages& B, SingleStages& S) {
  bands.round_skew(accuracy / h_, B, S);
  coupling_band_ = least_coupling_band_;
  for (const SingleMatrix& each : S) coupling_band_ = std::max(coupling_band_, each.band());
}

void SplitWorkspace::generate_coupled(const SingleStages& dW, SingleStages& dB) {
  generator_->upper_within(coupling_band_, dW, dB);
  solves_ += static_cast<long>(dW.size());
  mirror_skew_within(coupling_band_, dB);
}

StepReport SplitWorkspace::work() const {
  StepReport work;
  work.products = products.count() + single_products.count();
  work.poisson_solves = solves_;
  // A product in single precision counts half: vectors hold twice as many numbers.
  work.equivalent_products = products.equivalents() + 0.5 * single_products.equivalents();
  return work;
}

}  // namespace isosyrk
