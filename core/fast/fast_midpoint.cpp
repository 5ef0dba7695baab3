#include "isosyrk/fast/fast_midpoint.h"

#include <algorithm>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"

namespace isosyrk {

FastMidpoint::FastMidpoint(const EulerZeitlin& flow, const FastOptions& options)
    : FastForm(flow, options, {1}, std::max<Index>(24, flow.size() / 8)) {
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

void FastMidpoint::begin() {
  in_halves(
      [&](Share half) { reals(W_stage_, half) = reals(W0_, half) + reals(unknowns_[0][0], half); });
}

// (h/2) [B, W̃] and the upper triangle of (h²/4) B W̃ B, mirrored.
void FastMidpoint::commute(double h) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        solve_generator(0, W_stage_, B_, share, worker);
      },
      [&](std::size_t, Share share, Worker&) { finish_generator(0, B_, share); },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply(B_, W_stage_, M_, 1.0, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply_upper(M_, B_, MB_, 0.25 * h * h, share);
      },
      [&](std::size_t, Share share, Worker&) {
        mirror_skew(MB_, share);
        skew_part(M_, 0.5 * h, commutator_, share);
      });
}

double FastMidpoint::sweep(double h) {
  commute(h);
  in_halves([&](Share half) {
    half_of_squares(half)[0] = replace(
        unknowns_[0][0], half, [&](const auto& load) { return load(commutator_) + load(MB_); },
        [&](Index at, const auto& value) {
          stage_sums::store<8>(stage_sums::load<8>(W0_, at) + value, W_stage_, at);
        });
  });
  return largest_of_squares(1);
}

double FastMidpoint::residual(double h) {
  commute(h);
  in_halves([&](Share half) {
    half_of_squares(half)[0] = isosyrk::residual(
        unknowns_[0][0], [&](const auto& load) { return load(commutator_) + load(MB_); },
        residuals_[0][0], half);
  });
  return largest_of_squares(1);
}

Index FastMidpoint::linearise(double h, double accuracy) {
  in_halves([&](Share half) {
    narrow_generator(0, B_, h, accuracy, B_single_, half);
    narrow(W_stage_, W_single_, half);
    set_sum(B_single_, 0.25 * h * h, 0.5 * h, K_right_, half);
    start_correction(0, 0, half);
  });
  invert(h, accuracy);
  return B_single_.band();
}

// Y = scale X + shift 1.
void FastMidpoint::set_sum(const SingleMatrix& X, double scale, double shift, SingleMatrix& Y,
                           Share share) {
  reals(Y, share) = static_cast<float>(scale) * reals(X, share);
  const Rows rows(Y.size(), share);
  for (Index i = rows.begin; i < rows.end; ++i) {
    Y.re()[i * Y.stride() + i] += static_cast<float>(shift);
  }
  if (share.is_first()) Y.set_band(X.band());
}

// V for B_single_.
void FastMidpoint::invert(double h, double accuracy) {
  constexpr int most = 12;
  const auto guess_V = [&](Share half) { set_sum(B_single_, 0.5 * h, 1.0, V_, half); };
  in_halves([&](Share half) {
    set_sum(B_single_, -0.5 * h, 1.0, X_, half);
    if (!knows_V_) guess_V(half);
  });
  for (int k = 0; k < most; ++k) {
    in_phases(
        1,
        [&](std::size_t, Share share, Worker& worker) {
          worker.singles.multiply(X_, V_, product_, -1.0f, share);
        },
        [&](std::size_t, Share share, Worker&) {
          for_halves(share, [&](Share half) {
            set_sum(product_, 1.0, 1.0, product_, half);
            half_of_squares(half)[0] = static_cast<double>(reals(product_, half).square().sum());
          });
        });
    const double error = largest_of_squares(1);
    if (!(error < 1.0) && knows_V_) {  // of another time, or another h
      knows_V_ = false;
      in_halves(guess_V);
      continue;
    }
    in_phases(
        1,
        [&](std::size_t, Share share, Worker& worker) {
          worker.singles.multiply(V_, product_, other_, 1.0f, share);
        },
        [&](std::size_t, Share share, Worker&) {
          reals(V_, share) += reals(other_, share);
          measure(0, V_, share);
        },
        [&](std::size_t, Share share, Worker&) { cut(0, 0.1 * accuracy, V_, share); });
    if (error * error < accuracy) break;
  }
  knows_V_ = true;
  in_halves([&](Share half) { minus_adjoint(V_, minus_V_adjoint_, half); });
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
      },
      [&](std::size_t, Share share, Worker&) { mirror_skew(other_, share); });
  in_halves([&](Share half) {
    half_of_squares(half)[0] =
        replace(delta_[0][0], half, [&](const auto& load) { return load(other_); });
  });
  return largest_of_squares(1);
}

double FastMidpoint::couple(double) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        solve_generator(delta_[0][0], dB_, share, worker);
      },
      [&](std::size_t, Share share, Worker&) { finish_generator(dB_, share); },
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply(dB_, W_single_, product_, 1.0f, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.singles.multiply(product_, K_right_, other_, 1.0f, share);
      },
      [&](std::size_t, Share share, Worker&) { skew_part(other_, 1.0f, product_, share); },
      [&](std::size_t, Share share, Worker&) { couple_with(0, 0, product_, delta_[0][0], share); });
  return largest_of_squares(1);
}

void FastMidpoint::update(double, PlanarMatrix& W1) {
  in_halves(
      [&](Share half) { reals(W1, half) = reals(W0_, half) + 2.0 * reals(commutator_, half); });
}

}  // namespace isosyrk
