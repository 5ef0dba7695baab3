#include "core/fast_midpoint.h"

#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastMidpoint::FastMidpoint(const EulerZeitlin& flow, const FastOptions& options)
    : FastForm(flow, options, {1}) {
  W_stage_ = B_ = M_ = MB_ = commutator_ = zero();
}

void FastMidpoint::start_cold() { unknowns_[0][0].entries().setZero(); }

void FastMidpoint::begin() { reals(W_stage_) = reals(W0_) + reals(unknowns_[0][0]); }

double FastMidpoint::sweep(double h) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_, B_, worker);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply(B_, W_stage_, M_, 1.0, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply_upper(M_, B_, MB_, 0.25 * h * h, share);
      });
  in_halves([&](std::size_t half) {
    if (half == 0) {
      mirror_skew(MB_);
    } else {
      skew_part(M_, 0.5 * h, commutator_);
    }
  });
  const double change =
      replace(unknowns_[0][0], [&](const auto& load) { return load(commutator_) + load(MB_); });
  reals(W_stage_) = reals(W0_) + reals(unknowns_[0][0]);
  return std::sqrt(change);
}

void FastMidpoint::update(double, PlanarMatrix& W1) {
  W1.entries() = W0_.entries() + 2.0 * commutator_.entries();
}

}  // namespace isosyrk
