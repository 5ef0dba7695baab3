#include "core/fast_midpoint.h"

#include <algorithm>

#include "core/euler_zeitlin.h"
#include "core/mixed_sums.h"
#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastMidpoint::FastMidpoint(const EulerZeitlin& flow, const FastOptions& options)
    : FastForm(flow, options, {1},
               {.smallest = 48, .least_coupling_band = std::max<Index>(24, flow.size() / 8)}) {
  W_stage_ = B_ = M_ = MB_ = commutator_ = zero();
  const Singles one = singles(1);
  if (one.empty()) return;
  W_single_ = B_single_ = X_ = K_right_ = dB_ = product_ = other_ = one[0];
  V_ = minus_V_adjoint_ = one[0];
}

void FastMidpoint::start_cold() {
  unknowns_[0][0].entries().setZero();
  knows_V_ = false;
}

void FastMidpoint::begin() { reals(W_stage_) = reals(W0_) + reals(unknowns_[0][0]); }

// (h/2) [B, W̃] and the upper triangle of (h²/4) B W̃ B, mirrored.
void FastMidpoint::commute(double h) {
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
}

double FastMidpoint::sweep(double h) {
  commute(h);
  const double change = replace(
      unknowns_[0][0], [&](const auto& load) { return load(commutator_) + load(MB_); },
      [&](Index at, const auto& value) {
        stage_sums::store<8>(stage_sums::load<8>(W0_, at) + value, W_stage_, at);
      });
  return std::sqrt(change);
}

double FastMidpoint::residual(double h) {
  commute(h);
  in_halves([&](std::size_t half) {
    const HalfOfRows rows(W0_.size(), half);
    half_of_squares(half)[0] = isosyrk::residual(
        unknowns_[0][0], [&](const auto& load) { return load(commutator_) + load(MB_); },
        residuals_[0][0], rows.begin, rows.end);
  });
  return largest_of_squares(1);
}

Index FastMidpoint::linearise(double h, double accuracy) {
  in_phases(1, [&](std::size_t, Share share, Worker& worker) {
    if (share.part == 0) narrow_generator(B_, h, accuracy, B_single_, worker);
    if (share.part == share.parts - 1) narrow(W_stage_, W_single_, 0, 2 * W0_.size());
  });
  set_sum(B_single_, 0.25 * h * h, 0.5 * h, K_right_);
  invert(h, accuracy);
  return B_single_.band();
}

// Y = scale X + shift 1.
void FastMidpoint::set_sum(const SingleMatrix& X, double scale, double shift, SingleMatrix& Y) {
  Y.entries() = static_cast<float>(scale) * X.entries();
  for (Index i = 0; i < Y.size(); ++i) Y.re()[i * Y.stride() + i] += static_cast<float>(shift);
  Y.set_band(X.band());
}

// V for B_single_.
void FastMidpoint::invert(double h, double accuracy) {
  constexpr int most = 12;
  set_sum(B_single_, -0.5 * h, 1.0, X_);
  if (!knows_V_) set_sum(B_single_, 0.5 * h, 1.0, V_);
  for (int k = 0; k < most; ++k) {
    in_phases(1, [&](std::size_t, Share share, Worker& worker) {
      worker.singles.multiply(X_, V_, product_, -1.0f, share);
    });
    set_sum(product_, 1.0, 1.0, product_);
    const double error = static_cast<double>(product_.entries().norm());
    if (!(error < 1.0) && knows_V_) {  // of another time, or another h
      knows_V_ = false;
      set_sum(B_single_, 0.5 * h, 1.0, V_);
      continue;
    }
    in_phases(1, [&](std::size_t, Share share, Worker& worker) {
      worker.singles.multiply(V_, product_, other_, 1.0f, share);
    });
    reals(V_) += reals(other_);
    V_.set_band(other_.band());
    in_phases(1, [&](std::size_t, Share share, Worker& worker) {
      if (share.part == 0) cut_single(V_, 0.1 * accuracy, worker);
    });
    if (error * error < accuracy) break;
  }
  knows_V_ = true;
  minus_adjoint(V_, minus_V_adjoint_);
  minus_V_adjoint_.set_band(V_.band());
}

double FastMidpoint::transport(double) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply(V_, rhs_[0][0], product_, 1.0f, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply_upper(product_, minus_V_adjoint_, other_, -1.0f, share);
      });
  mirror_skew(other_);
  return std::sqrt(replace(delta_[0][0], [&](const auto& load) { return load(other_); }));
}

void FastMidpoint::couple(double) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        if (share.part == 0) single_generator(delta_[0][0], dB_, worker);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply(dB_, W_single_, product_, 1.0f, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply(product_, K_right_, other_, 1.0f, share);
      });
  skew_part(other_, 1.0f, product_);
  reals(next_rhs_[0][0]) = reals(residuals_[0][0]) + reals(product_);
}

void FastMidpoint::update(double, PlanarMatrix& W1) {
  W1.entries() = W0_.entries() + 2.0 * commutator_.entries();
}

}  // namespace isosyrk
