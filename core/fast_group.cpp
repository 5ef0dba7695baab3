#include "core/fast_group.h"

#include "core/euler_zeitlin.h"
#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastGroup::FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options)
    : FastForm(flow, options, {tableau.stages()}), tableau_(tableau) {
  require_consistent(tableau);
  Q1_ = zero();
  W0Q_ = W_stage_ = zeros(places(tableau.stages()));
  B_ = QB_ = zeros(tableau.stages());
  identity_ = identity();
  change_.resize(2 * tableau.stages());
  tolerance_ = options.solver.tolerance;
  constexpr Index smallest = 48;  // below, the second transport saves less than it costs (measured)
  transports_twice_ = options.transport_twice.value_or(flow.size() >= smallest);
}

void FastGroup::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
}

// Q_i = I - h Σ_j a_ij Q_j B_j; returns the largest change.
double FastGroup::transport(double h) {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(Q.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.planar.multiply(Q[j], B_[j], QB_[j], 1.0, share);
  });
  update_in_halves(identity_, -h, tableau_.a, QB_, Q, change_);
  return largest_change_of_halves(change_);
}

double FastGroup::sweep(double h) {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  in_phases(
      Q.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(W0_, Q[j], W0Q_[place(j)], 1.0, share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q[j], W0Q_[place(j)], W_stage_[place(j)], share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[place(j)], B_[j], worker);
      });
  const double change = transport(h);
  if (transports_twice_ && change >= tolerance_) transport(h);
  return change;
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
