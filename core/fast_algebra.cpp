#include "core/fast_algebra.h"

#include <algorithm>
#include <utility>

#include "core/euler_zeitlin.h"
#include "core/mixed_sums.h"
#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastAlgebra::FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau,
                         const FastOptions& options)
    : FastForm(flow, options, {tableau.stages(), tableau.stages() * (tableau.stages() + 1) / 2},
               {.smallest = 48, .least_coupling_band = std::max<Index>(32, 3 * flow.size() / 8)}),
      tableau_(tableau) {
  require_consistent(tableau);
  const Index s = tableau.stages();
  X_sum_ = X_next_ = W_stage_ = B_ = P_ = zeros(s);
  M_next_ = minus_adjoints_ = Y_ = unknowns_[1];
  sum_ = skew_ = zeros(places(s));
  for (std::size_t k = 0; k < stages(); ++k) {
    for (std::size_t j = 0; j <= k; ++j) {
      if (j < k) off_diagonal_.push_back(pairs_.size());
      pairs_.emplace_back(j, k);
    }
  }
  X_change_ = W_change_ = RealVector::Zero(s);
  M_change_ = RealVector::Zero(static_cast<Index>(pairs_.size()));
  B_single_ = P_single_ = dW_ = dB_ = singles(s);
  Y_single_ = single_input_ = single_product_ = minus_single_adjoints_ = residuals_[1];
}

void FastAlgebra::start_cold() {
  for (Stages& kind : unknowns_) {
    for (PlanarMatrix& unknown : kind) unknown.entries().setZero();
  }
}

void FastAlgebra::begin() { update_stage_vorticities(); }

// X_next_ and, from it, M_next_.
void FastAlgebra::form_next(double h) {
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        if (share.part == 0) generator(W_stage_[i], B_[i], worker);
        if (share.part == share.parts - 1) reals(P_[i]) = reals(W0_) + reals(X_sum_[i]);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.planar.multiply(P_[i], B_[i], X_next_[i], -h, share);
      });
  in_phases(
      pairs_.size(),
      [&](std::size_t p, Share share, Worker&) {
        const auto [j, k] = pairs_[p];
        auto input = part_of(Y_[p], share);
        input = part_of(X_next_[k], share) + a(j, 0) * part_of(M(0, k), share);
        for (std::size_t m = 1; m < stages(); ++m) input += a(j, m) * part_of(M(m, k), share);
      },
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.planar, p, B_, Y_, M_next_, h, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(M_next_[p], share);
      });
}

double FastAlgebra::sweep(double h) {
  form_next(h);
  in_phases(stages(), [&](std::size_t i, Share share, Worker&) {
    if (share.part != 0) return;
    X_change_(static_cast<Index>(i)) = squared_change(X_next_[i], unknowns_[0][i]);
  });
  in_phases(pairs_.size(), [&](std::size_t p, Share share, Worker&) {
    if (share.part != 0) return;
    M_change_(static_cast<Index>(p)) = squared_change(M_next_[p], unknowns_[1][p]);
  });
  std::swap(unknowns_[0], X_next_);
  std::swap(unknowns_[1], M_next_);
  update_stage_vorticities();
  return larger(largest_change(X_change_),
                larger(largest_change(M_change_), largest_change(W_change_)));
}

double FastAlgebra::residual(double h) {
  form_next(h);
  const auto differences = [&](const Stages& next, const Stages& X, Singles& R) {
    in_halves_of(X.size(), [&](std::size_t i, std::size_t half) {
      const HalfOfRows rows(W0_.size(), half);
      half_of_squares(half)[i] = isosyrk::residual(
          X[i], [&](const auto& load) { return load(next[i]); }, R[i], rows.begin, rows.end);
    });
    return largest_of_squares(static_cast<Index>(X.size()));
  };
  const double of_X = differences(X_next_, unknowns_[0], residuals_[0]);
  const double of_M = differences(M_next_, unknowns_[1], residuals_[1]);
  return larger(larger(of_X, of_M), correct_stage_vorticities(residuals_[0], residuals_[1]));
}

Index FastAlgebra::linearise(double h, double accuracy) {
  const Index n = W0_.size();
  in_phases(stages(), [&](std::size_t i, Share share, Worker& worker) {
    if (share.part == 0) narrow_generator(B_[i], h, accuracy, B_single_[i], worker);
    if (share.part == share.parts - 1) narrow(P_[i], P_single_[i], 0, 2 * n);
  });
  in_halves_of(pairs_.size(), [&](std::size_t p, std::size_t half) {
    const HalfOfRows rows(n, half);
    narrow(Y_[p], Y_single_[p], rows.begin, rows.end);
  });
  return widest_band(B_single_);
}

// dW_: what corrections to X and M make of W̃; returns the largest.
double FastAlgebra::correct_stage_vorticities(const Singles& X, const Singles& M) {
  in_phases(stages(), [&](std::size_t i, Share share, Worker&) {
    if (share.part != 0) return;
    const auto weight = [&](std::size_t j, std::size_t k) {
      return static_cast<float>(a(i, j) * a(i, k));
    };
    SingleMatrix& sum = single_input_[i];
    reals(sum) = static_cast<float>(a(i, 0)) * reals(X[0]);
    for (std::size_t k = 1; k < stages(); ++k) {
      reals(sum) += static_cast<float>(a(i, k)) * reals(X[k]);
      for (std::size_t j = 0; j < k; ++j) reals(sum) += weight(j, k) * reals(M[pair(j, k)]);
    }
    skew_part(sum, 1.0f, dW_[i]);
    for (std::size_t j = 0; j < stages(); ++j) reals(dW_[i]) += weight(j, j) * reals(M[pair(j, j)]);
    W_change_(static_cast<Index>(i)) = static_cast<double>(reals(dW_[i]).square().sum());
  });
  return largest_change(W_change_);
}

double FastAlgebra::transport(double h) {
  Singles& delta = delta_[0];
  const auto step_of = static_cast<float>(h);
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker&) {
        if (share.part != 0) return;
        combine(tableau_.a.row(static_cast<Index>(i)).cast<float>(), delta, single_input_[i]);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.singles.multiply(single_input_[i], B_single_[i], single_product_[i], -step_of,
                                share);
      });
  const double of_X = add_product_to_rhs(0);
  in_phases(off_diagonal_.size(), [&](std::size_t which, Share share, Worker&) {
    const std::size_t p = off_diagonal_[which];
    minus_adjoint(delta_[1][p], minus_single_adjoints_[p], share);
  });
  in_phases(
      pairs_.size(),
      [&](std::size_t p, Share share, Worker&) {
        const auto [j, k] = pairs_[p];
        auto input = part_of(single_input_[p], share);
        input = part_of(delta[k], share) - part_of(residuals_[0][k], share);
        for (std::size_t m = 0; m < stages(); ++m) {
          input += static_cast<float>(a(j, m)) * part_of(epsilon(m, k), share);
        }
      },
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.singles, p, B_single_, single_input_, single_product_, step_of, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(single_product_[p], share);
      });
  return larger(of_X, add_product_to_rhs(1));
}

// δ = rhs + product for one kind of unknowns; returns the largest change.
double FastAlgebra::add_product_to_rhs(std::size_t kind) {
  Singles& delta = delta_[kind];
  in_halves_of(delta.size(), [&](std::size_t i, std::size_t half) {
    const Half numbers(reals(delta[i]).size(), half);
    half_of_squares(half)[i] = replace_some(
        delta[i], numbers.begin, numbers.end,
        [&](const auto& load) { return load(rhs_[kind][i]) + load(single_product_[i]); });
  });
  return largest_of_squares(static_cast<Index>(delta.size()));
}

void FastAlgebra::couple(double h) {
  const auto step_of = static_cast<float>(h);
  correct_stage_vorticities(delta_[0], delta_[1]);
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        if (share.part == 0) single_generator(dW_[i], dB_[i], worker);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.singles.multiply(P_single_[i], dB_[i], single_product_[i], -step_of, share);
      },
      [&](std::size_t i, Share share, Worker&) {
        part_of(next_rhs_[0][i], share) =
            part_of(residuals_[0][i], share) + part_of(single_product_[i], share);
      });
  in_phases(
      pairs_.size(),
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.singles, p, dB_, Y_single_, single_product_, step_of, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(single_product_[p], share);
      },
      [&](std::size_t p, Share share, Worker&) {
        part_of(next_rhs_[1][p], share) =
            part_of(residuals_[1][p], share) + part_of(single_product_[p], share);
      });
}

// W̃_i, and what else the next sweep takes, from the unknowns.
void FastAlgebra::update_stage_vorticities() {
  const std::size_t s = stages();
  in_phases(off_diagonal_.size(), [&](std::size_t which, Share share, Worker&) {
    const std::size_t p = off_diagonal_[which];
    minus_adjoint(unknowns_[1][p], minus_adjoints_[p], share);
  });
  in_phases(s, [&](std::size_t i, Share share, Worker&) {
    if (share.part != 0) return;
    PlanarMatrix& sum = sum_[place(i)];
    PlanarMatrix& skew = skew_[place(i)];
    combine(tableau_.a.row(static_cast<Index>(i)), unknowns_[0], X_sum_[i]);
    const PlanarMatrix* S = &X_sum_[i];
    if (s > 1) {
      reals(sum) = reals(X_sum_[i]) + a(i, 0) * a(i, 1) * reals(M(0, 1));
      for (std::size_t k = 2; k < s; ++k) {
        for (std::size_t j = 0; j < k; ++j) reals(sum) += a(i, j) * a(i, k) * reals(M(j, k));
      }
      S = &sum;
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
  combine(h * tableau_.b, C, sum_[0]);
  skew_part(sum_[0], 1.0, skew_[0]);
  W1.entries() = W0_.entries() + skew_[0].entries();
}

}  // namespace isosyrk
