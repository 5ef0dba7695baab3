#include "core/fast_group.h"

#include <algorithm>

#include "core/euler_zeitlin.h"
#include "core/mixed_sums.h"
#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastGroup::FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options)
    : FastForm(flow, options, {tableau.stages()},
               {.smallest = 32, .least_coupling_band = std::max<Index>(16, flow.size() / 8)}),
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
  W0_cut_.entries() = W0_.entries();
  in_phases(1, [&](std::size_t, Share share, Worker& worker) {
    if (share.part == 0) cut(W0_cut_, step() * W0_weight_, worker);
  });
}

void FastGroup::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
}

void FastGroup::begin() {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(Q.size(), [&](std::size_t j, Share share, Worker& worker) {
    if (share.part == 0) cut(Q[j], worker);
  });
}

void FastGroup::transport_stages() {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(Q.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.planar.multiply(Q[j], B_[j], QB_[j], 1.0, share);
  });
}

void FastGroup::form_stages() {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(
      Q.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(W0_cut_, Q[j], W0Q_[j], 1.0, share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q[j], W0Q_[j], W_stage_[place(j)], share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[place(j)], B_[j], worker);
      });
}

double FastGroup::sweep(double h) {
  form_stages();
  transport_stages();
  const double change = update_in_halves(identity_, -h, tableau_.a, QB_, unknowns_[0]);
  if (corrects() && change >= tolerance_) {
    begin();  // Q has another band now
    transport_stages();
    update_in_halves(identity_, -h, tableau_.a, QB_, unknowns_[0]);
  }
  begin();
  return change;
}

double FastGroup::residual(double h) {
  form_stages();
  transport_stages();
  return residuals_in_halves(identity_, -h, tableau_.a, QB_, unknowns_[0], residuals_[0]);
}

Index FastGroup::linearise(double h, double accuracy) {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  const Index rows = 2 * W0_.size();
  in_phases(Q.size(), [&](std::size_t j, Share share, Worker& worker) {
    if (share.part == 0) narrow_generator(B_[j], h, accuracy, B_single_[j], worker);
    if (share.part == share.parts - 1) {
      narrow(Q[j], Q_single_[j], 0, rows);
      narrow(W0Q_[j], W0Q_single_[j], 0, rows);
    }
  });
  return widest_band(B_single_);
}

double FastGroup::transport(double h) {
  const Singles& delta = delta_[0];
  in_phases(delta.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.singles.multiply(delta[j], B_single_[j], product_[j], 1.0f, share);
  });
  return update_in_halves(rhs_[0], -h, tableau_.a, product_, delta_[0]);
}

void FastGroup::couple(double h) {
  const Singles& delta = delta_[0];
  in_phases(
      delta.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        worker.singles.multiply_adjoint_left_within(coupling_band(), delta[j], W0Q_single_[j],
                                                    N_[j], share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        if (share.part != 0) return;
        skew_part(N_[j], 1.0f, dW_[j]);
        single_generator(dW_[j], dB_[j], worker);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.singles.multiply(Q_single_[j], dB_[j], product_[j], 1.0f, share);
      });
  update_in_halves(residuals_[0], -h, tableau_.a, product_, next_rhs_[0]);
}

void FastGroup::update(double h, PlanarMatrix& W1) {
  combine(identity_, -h * tableau_.b, QB_, Q1_);
  in_phases(
      1,
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply(W0_, Q1_, W0Q_[0], 1.0, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q1_, W0Q_[0], W1, share);
      });
  mirror_skew(W1);
}

}  // namespace isosyrk
