#include "core/fast_cotangent.h"

#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastCotangent::FastCotangent(const EulerZeitlin& flow, const Tableau& tableau,
                             const FastOptions& options)
    : FastForm(flow, options, {tableau.stages(), tableau.stages()}), tableau_(tableau) {
  require_consistent(tableau);
  Q1_ = P1_ = zero();
  W_stage_ = B_ = zeros(places(tableau.stages()));
  QB_ = PB_ = zeros(tableau.stages());
  identity_ = identity();
  Q_change_.resize(2 * tableau.stages());
  P_change_.resize(2 * tableau.stages());
}

void FastCotangent::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
  for (PlanarMatrix& P : unknowns_[1]) P.entries() = W0_.entries();
}

double FastCotangent::sweep(double h) {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  std::vector<PlanarMatrix>& P = unknowns_[1];
  in_phases(
      Q.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q[j], P[j], W_stage_[place(j)], share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[place(j)], B_[place(j)], worker);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(Q[j], B_[place(j)], QB_[j], 1.0, share);
        worker.planar.multiply(P[j], B_[place(j)], PB_[j], 1.0, share);
      });
  update_in_halves(identity_, -h, tableau_.a, QB_, Q, Q_change_);
  update_in_halves(W0_, -h, tableau_.a, PB_, P, P_change_);
  return larger(largest_change_of_halves(Q_change_), largest_change_of_halves(P_change_));
}

void FastCotangent::update(double h, PlanarMatrix& W1) {
  combine(identity_, -h * tableau_.b, QB_, Q1_);
  combine(W0_, -h * tableau_.b, PB_, P1_);
  in_phases(1, [&](std::size_t, Share share, Worker& worker) {
    worker.planar.multiply_adjoint_left_upper(Q1_, P1_, W1, share);
  });
  mirror_skew(W1);
}

}  // namespace isosyrk
