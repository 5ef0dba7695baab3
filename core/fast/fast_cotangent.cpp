#include "isosyrk/fast/fast_cotangent.h"

#include <algorithm>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"

namespace isosyrk {

FastCotangent::FastCotangent(const EulerZeitlin& flow, const Tableau& tableau,
                             const FastOptions& options)
    : FastForm(
          flow, options,
          {static_cast<std::size_t>(tableau.stages()), static_cast<std::size_t>(tableau.stages())},
          std::max<Index>(32, 3 * flow.size() / 8)),
      tableau_(tableau) {
  require_consistent(tableau);
  Q1_ = P1_ = zero();
  W_stage_ = zeros(places(tableau.stages()));
  B_ = QB_ = PB_ = zeros(tableau.stages());
  identity_ = identity();
  Q_single_ = P_single_ = B_single_ = N_ = N_of_P_ = dB_ = Q_product_ = P_product_ =
      singles(tableau.stages());
}

void FastCotangent::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
  for (PlanarMatrix& P : unknowns_[1]) P.entries() = W0_.entries();
}

void FastCotangent::begin() {
  cut_unknowns(0);
  cut_unknowns(1);
}

// Q_j B_j and P_j B_j.
void FastCotangent::transport_stages() {
  const std::vector<PlanarMatrix>& Q = unknowns_[0];
  const std::vector<PlanarMatrix>& P = unknowns_[1];
  in_phases(
      Q.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q[j], P[j], W_stage_[place(j)], share);
      },
      [&](std::size_t j, Share share, Worker& worker) {
        solve_generator(j, W_stage_[place(j)], B_[j], share, worker);
      },
      [&](std::size_t j, Share share, Worker&) { finish_generator(j, B_[j], share); },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.planar.multiply(Q[j], B_[j], QB_[j], 1.0, share);
        worker.planar.multiply(P[j], B_[j], PB_[j], 1.0, share);
      });
}

double FastCotangent::sweep(double h) {
  transport_stages();
  const double Q_change = update_and_cut(0, identity_, -h, tableau_.a, QB_);
  const double P_change = update_and_cut(1, W0_, -h, tableau_.a, PB_);
  return larger(Q_change, P_change);
}

double FastCotangent::residual(double h) {
  transport_stages();
  const double of_Q =
      residuals_of_stages(identity_, -h, tableau_.a, QB_, unknowns_[0], residuals_[0]);
  const double of_P = residuals_of_stages(W0_, -h, tableau_.a, PB_, unknowns_[1], residuals_[1]);
  return larger(of_Q, of_P);
}

Index FastCotangent::linearise(double h, double accuracy) {
  in_halves_of(B_.size(), [&](std::size_t j, Share half) {
    narrow_generator(j, B_[j], h, accuracy, B_single_[j], half);
    narrow(unknowns_[0][j], Q_single_[j], half);
    narrow(unknowns_[1][j], P_single_[j], half);
    for (const std::size_t kind : {0, 1}) start_correction(kind, j, half);
  });
  return widest_band(B_single_);
}

double FastCotangent::transport(double h) {
  in_phases(B_.size(), [&](std::size_t j, Share share, Worker& worker) {
    worker.singles.multiply(delta_[0][j], B_single_[j], Q_product_[j], 1.0f, share);
    worker.singles.multiply(delta_[1][j], B_single_[j], P_product_[j], 1.0f, share);
  });
  const double of_Q = update_stages(rhs_[0], -h, tableau_.a, Q_product_, delta_[0]);
  const double of_P = update_stages(rhs_[1], -h, tableau_.a, P_product_, delta_[1]);
  return larger(of_Q, of_P);
}

double FastCotangent::couple(double h) {
  in_phases(
      B_.size(),
      [&](std::size_t j, Share share, Worker& worker) {
        SingleProducts& singles = worker.singles;
        const Index band = coupling_band();
        singles.multiply_adjoint_left_upper_within(band, delta_[0][j], P_single_[j], N_[j], share);
        singles.multiply_adjoint_left_upper_within(band, Q_single_[j], delta_[1][j], N_of_P_[j],
                                                   share);
      },
      [&](std::size_t j, Share share, Worker&) { reals(N_[j], share) += reals(N_of_P_[j], share); },
      [&](std::size_t j, Share share, Worker& worker) {
        solve_generator(N_[j], dB_[j], share, worker);
      },
      [&](std::size_t j, Share share, Worker&) { finish_generator(dB_[j], share); },
      [&](std::size_t j, Share share, Worker& worker) {
        worker.singles.multiply(Q_single_[j], dB_[j], Q_product_[j], 1.0f, share);
        worker.singles.multiply(P_single_[j], dB_[j], P_product_[j], 1.0f, share);
      });
  const auto change = [&](std::size_t kind, const Singles& product) {
    return update_stages(
        residuals_[kind], -h, tableau_.a, product, next_rhs_[kind],
        [&](std::size_t j, Share share, Worker&) { shift(kind, j, delta_[kind][j], share); });
  };
  const double of_Q = change(0, Q_product_);
  const double of_P = change(1, P_product_);
  return larger(of_Q, of_P);
}

void FastCotangent::update(double h, PlanarMatrix& W1) {
  in_phases(
      1,
      [&](std::size_t, Share share, Worker&) {
        combine(identity_, -h * tableau_.b, QB_, Q1_, share);
        combine(W0_, -h * tableau_.b, PB_, P1_, share);
      },
      [&](std::size_t, Share share, Worker& worker) {
        worker.planar.multiply_adjoint_left_upper(Q1_, P1_, W1, share);
      },
      [&](std::size_t, Share share, Worker&) { mirror_skew(W1, share); });
}

}  // namespace isosyrk
