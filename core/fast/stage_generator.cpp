#include "isosyrk/fast/stage_generator.h"

#include <algorithm>
#include <stdexcept>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/skew.h"

namespace isosyrk {

StageGenerator::StageGenerator(const Flow& flow)
    : n_(flow.size()), generator_(flow.split_generator()) {
  if (generator_ == nullptr) {
    throw std::invalid_argument(
        "solver fast: this flow has no generator in split storage, as Euler-Zeitlin has "
        "(published forms need none)");
  }
}

Index StageGenerator::least_coupling_band(const CouplingBand& band) const {
  return generator_->damps_fine_scales() ? std::min(band(n_), n_ - 1) : n_ - 1;
}

void StageGenerator::generate(Generators& B, const SplitStages& W, const BandTruncation& bands,
                              double tail) {
  generator_->upper_within(n_ - 1, W, B.B);
  solves_ += static_cast<long>(W.size());
  bands.truncate_skew(B.B, B.squares, tail);
}

void StageGenerator::round(RoundedGenerators& S, const Generators& B, const BandTruncation& bands,
                           double tail, Index least_band) {
  bands.round_skew(S.B, B.B, B.squares, tail);
  S.coupling_band = least_band;
  for (const SingleMatrix& each : S.B) S.coupling_band = std::max(S.coupling_band, each.band());
}

template <class Real>
void StageGenerator::generate_one(SplitMatrixOf<Real>& B, const SplitMatrixOf<Real>& W) {
  // At least 1: a rigid rotation that is left out changes the diagonals 0 and 1 of any B(W).
  const Index band = std::min(std::max<Index>(W.band(), 1), n_ - 1);
  change_band(B, band);
  generator_->upper_within(band, {&W, 1}, {&B, 1});
  ++solves_;
  mirror_skew_in_band(B);
}

void StageGenerator::generate_within(SingleStages& dB, Index band, const SingleStages& dW) {
  generator_->upper_within(band, dW, dB);
  solves_ += static_cast<long>(dW.size());
  mirror_skew_within(dB, band);
}

template void StageGenerator::generate_one(SplitMatrix&, const SplitMatrix&);
template void StageGenerator::generate_one(SingleMatrix&, const SingleMatrix&);

}  // namespace isosyrk
