#include "core/fast_algebra.h"

#include <utility>

#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastAlgebra::FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau,
                         const FastOptions& options)
    : FastForm(flow, options, {tableau.stages(), tableau.stages() * (tableau.stages() + 1) / 2}),
      tableau_(tableau) {
  require_consistent(tableau);
  X_sum_ = X_next_ = W_stage_ = B_ = zeros(tableau.stages());
  M_next_ = minus_adjoints_ = unknowns_[1];
  input_ = zeros(places(static_cast<Index>(M_next_.size())));
  skew_ = zeros(places(tableau.stages()));
  for (std::size_t k = 0; k < stages(); ++k) {
    for (std::size_t j = 0; j <= k; ++j) pairs_.emplace_back(j, k);
  }
  X_change_ = W_change_ = RealVector::Zero(tableau.stages());
  M_change_ = RealVector::Zero(static_cast<Index>(pairs_.size()));
}

void FastAlgebra::start_cold() {
  for (Stages& kind : unknowns_) {
    for (PlanarMatrix& unknown : kind) unknown.entries().setZero();
  }
}

void FastAlgebra::begin() { update_stage_vorticities(); }

double FastAlgebra::sweep(double h) {
  Stages& X = unknowns_[0];
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[i], B_[i], worker);
        if (share.part == share.parts - 1) {
          reals(input_[place(i)]) = reals(W0_) + reals(X_sum_[i]);
        }
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.planar.multiply(input_[place(i)], B_[i], X_next_[i], -h, share);
      },
      [&](std::size_t i, Share share, Worker&) {
        if (share.part == 0) X_change_(static_cast<Index>(i)) = squared_change(X_next_[i], X[i]);
      });
  std::swap(X, X_next_);
  in_phases(
      pairs_.size(),
      [&](std::size_t p, Share share, Worker&) {
        if (share.part != 0) return;
        const auto [j, k] = pairs_[p];
        PlanarMatrix& input = input_[place(p)];
        reals(input) = reals(X[k]) + a(j, 0) * reals(M(0, k));
        for (std::size_t m = 1; m < stages(); ++m) reals(input) += a(j, m) * reals(M(m, k));
      },
      [&](std::size_t p, Share share, Worker& worker) {
        const auto [j, k] = pairs_[p];
        if (j == k) {
          worker.planar.multiply_upper(B_[j], input_[place(p)], M_next_[p], h, share);
        } else {
          worker.planar.multiply(B_[j], input_[place(p)], M_next_[p], h, share);
        }
      },
      [&](std::size_t p, Share share, Worker&) {
        if (share.part != 0) return;
        if (pairs_[p].first == pairs_[p].second) mirror_skew(M_next_[p]);
        M_change_(static_cast<Index>(p)) = squared_change(M_next_[p], unknowns_[1][p]);
      });
  std::swap(unknowns_[1], M_next_);
  update_stage_vorticities();
  return larger(largest_change(X_change_),
                larger(largest_change(M_change_), largest_change(W_change_)));
}

// W̃_i, and what else the next sweep takes, from the unknowns.
void FastAlgebra::update_stage_vorticities() {
  const std::size_t s = stages();
  in_phases(pairs_.size(), [&](std::size_t p, Share share, Worker&) {
    const auto [j, k] = pairs_[p];
    if (share.part == 0 && j < k) minus_adjoint(M(j, k), minus_adjoints_[p]);
  });
  in_phases(s, [&](std::size_t i, Share share, Worker&) {
    if (share.part != 0) return;
    PlanarMatrix& input = input_[place(i)];
    PlanarMatrix& skew = skew_[place(i)];
    combine(tableau_.a.row(static_cast<Index>(i)), unknowns_[0], X_sum_[i]);
    const PlanarMatrix* S = &X_sum_[i];
    if (s > 1) {
      reals(input) = reals(X_sum_[i]) + a(i, 0) * a(i, 1) * reals(M(0, 1));
      for (std::size_t k = 2; k < s; ++k) {
        for (std::size_t j = 0; j < k; ++j) reals(input) += a(i, j) * a(i, k) * reals(M(j, k));
      }
      S = &input;
    }
    skew_part(*S, 1.0, skew);
    for (std::size_t j = 1; j < s; ++j) reals(skew) += a(i, j) * a(i, j) * reals(M(j, j));
    const double first = a(i, 0) * a(i, 0);
    W_change_(static_cast<Index>(i)) = replace(W_stage_[i], [&](const auto& load) {
      return load(W0_) + load(skew) + first * load(M(0, 0));
    });
  });
}

void FastAlgebra::update(double h, PlanarMatrix& W1) {
  Stages& C = X_next_;
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[i], B_[i], worker);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.planar.multiply(B_[i], W_stage_[i], C[i], 1.0, share);
      });
  combine(h * tableau_.b, C, input_[0]);
  skew_part(input_[0], 1.0, skew_[0]);
  W1.entries() = W0_.entries() + skew_[0].entries();
}

}  // namespace isosyrk
