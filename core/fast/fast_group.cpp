#include "isosyrk/fast/fast_group.h"

#include <algorithm>
#include <utility>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"

namespace isosyrk {
namespace {

// Of a stage that two threads share, one forms W̃_j and the other B_j and Q_j B_j from it, δW̃_j and
// δB_j likewise: halves of all this, of which each thread has to fetch most from the other, take
// 5 % of a step more at n = 129, s = 3, and 9 % at n = 65 (measured).
template <class Phase>
Undivided<Phase> by_first(Phase phase) {
  return undivided(0, std::move(phase));
}
template <class Phase>
Undivided<Phase> by_second(Phase phase) {
  return undivided(1, std::move(phase));
}

}  // namespace

FastGroup::FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options)
    : FastForm(flow, options, {static_cast<std::size_t>(tableau.stages())},
               std::max<Index>(16, flow.size() / 8)),
      tableau_(tableau) {
  require_consistent(tableau);
  const Index s = tableau.stages();
  W0_cut_ = Q1_ = zero();
  W_stage_ = zeros(places(s));
  W0Q_ = B_ = QB_ = zeros(s);
  identity_ = identity();
  Q_single_ = B_single_ = W0Q_single_ = N_ = dW_ = dB_ = product_ = singles(s);
  tolerance_ = options.solver.tolerance;
  W0_weight_ = 0.5 / hbar(flow.convention(), flow.size());  // of Δ⁻¹ / ħ at most
}

void FastGroup::begin_step() {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker&) {
        reals(W0_cut_, share) = reals(W0_, share);
        measure(0, W0_cut_, share);
      },
      [&](std::size_t, Share share, Worker&) {
        cut(0, left_out() / (step() * W0_weight_), W0_cut_, share);
      });
}

void FastGroup::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
}

void FastGroup::begin() { cut_unknowns(0); }

// Q_j from the last Q_j B_j.
double FastGroup::update_Q(double h) { return update_and_cut(0, identity_, -h, tableau_.a, QB_); }

void FastGroup::transport_stages() {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(Q.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.planar.multiply(Q[j], B_[j], QB_[j], 1.0, share);
  });
}

void FastGroup::form_stages() {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(
      Q.size(), by_first([&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(W0_cut_, Q[j], W0Q_[j], 1.0, share);
      }),
      by_first([&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q[j], W0Q_[j], W_stage_[place(j)], share);
      }),
      by_second([&](std::size_t j, Share share, Worker& worker) {
        solve_generator(j, W_stage_[place(j)], B_[j], share, worker);
      }),
      by_second([&](std::size_t j, Share share, Worker&) { finish_generator(j, B_[j], share); }),
      by_second([&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(Q[j], B_[j], QB_[j], 1.0, share);
      }));
}

double FastGroup::sweep(double h) {
  form_stages();
  const double change = update_Q(h);
  if (corrects() && change >= tolerance_) {
    transport_stages();
    update_Q(h);
  }
  return change;
}

double FastGroup::residual(double h) {
  form_stages();
  return residuals_of_stages(identity_, -h, tableau_.a, QB_, unknowns_[0], residuals_[0]);
}

Index FastGroup::linearise(double h, double accuracy) {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_halves_of(Q.size(), [&](std::size_t j, Share half) {
    narrow_generator(j, B_[j], h, accuracy, B_single_[j], half);
    narrow(Q[j], Q_single_[j], half);
    narrow(W0Q_[j], W0Q_single_[j], half);
    start_correction(0, j, half);
  });
  return widest_band(B_single_);
}

double FastGroup::transport(double h) {
  const Singles& delta = delta_[0];
  in_phases(delta.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.singles.multiply(delta[j], B_single_[j], product_[j], 1.0f, share);
  });
  return update_stages(rhs_[0], -h, tableau_.a, product_, delta_[0]);
}

double FastGroup::couple(double h) {
  Singles& delta = delta_[0];
  in_phases(
      delta.size(), by_first([&](std::size_t j, Share share, Worker& worker) {
        worker.singles.multiply_adjoint_left_within(coupling_band(), delta[j], W0Q_single_[j],
                                                    N_[j], share);
      }),
      by_first([&](std::size_t j, Share share, Worker&) {
        upper_skew_part_within(coupling_band(), N_[j], dW_[j], share);
      }),
      by_second([&](std::size_t j, Share share, Worker& worker) {
        solve_generator(dW_[j], dB_[j], share, worker);
      }),
      by_second([&](std::size_t j, Share share, Worker&) { finish_generator(dB_[j], share); }),
      by_second([&](std::size_t j, Share share, Worker& worker) {
        worker.singles.multiply(Q_single_[j], dB_[j], product_[j], 1.0f, share);
      }));
  return update_stages(residuals_[0], -h, tableau_.a, product_, next_rhs_[0],
                       [&](std::size_t j, Share share, Worker&) { shift(0, j, delta[j], share); });
}

void FastGroup::update(double h, PlanarMatrix& W1) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker&) {
        combine(identity_, -h * tableau_.b, QB_, Q1_, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply(W0_, Q1_, W0Q_[0], 1.0, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q1_, W0Q_[0], W1, share);
      },
      [&](std::size_t, Share share, Worker&) { mirror_skew(W1, share); });
}

}  // namespace isosyrk
