#include "core/fast_algebra.h"

#include <algorithm>
#include <utility>

#include "core/euler_zeitlin.h"
#include "core/mixed_sums.h"
#include "core/planar_blocks.h"
#include "core/stage_sums.h"

namespace isosyrk {

// Two threads have as many full products and as many triangles to form.
FastAlgebra::Pairs::Pairs(std::size_t stages) {
  std::vector<std::pair<std::size_t, std::size_t>> full, triangles, in_halves;
  for (std::size_t k = 0; k < stages; ++k) {
    for (std::size_t j = 0; j < k; ++j) full.emplace_back(j, k);
    triangles.emplace_back(k, k);
  }
  for (auto* const kind : {&full, &triangles}) {
    if (kind->size() % 2 == 0) continue;
    in_halves.push_back(kind->back());
    kind->pop_back();
  }
  for (const std::size_t half : {0, 1}) {
    for (const auto* const kind : {&full, &triangles}) {
      const auto size = static_cast<std::ptrdiff_t>(kind->size() / 2);
      const auto first = kind->begin() + static_cast<std::ptrdiff_t>(half) * size;
      order.insert(order.end(), first, first + size);
    }
  }
  order.insert(order.end(), in_halves.begin(), in_halves.end());
  halved = in_halves.size();
}

FastAlgebra::FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau,
                         const FastOptions& options)
    : FastAlgebra(flow, tableau, options, Pairs(static_cast<std::size_t>(tableau.stages()))) {}

FastAlgebra::FastAlgebra(const EulerZeitlin& flow, const Tableau& tableau,
                         const FastOptions& options, Pairs pairs)
    : FastForm(flow, options, {static_cast<std::size_t>(tableau.stages()), pairs.items()},
               {.smallest = 48, .least_coupling_band = std::max<Index>(32, 3 * flow.size() / 8)}),
      tableau_(tableau),
      pairs_(std::move(pairs)) {
  require_consistent(tableau);
  const Index s = tableau.stages();
  X_sum_ = X_next_ = W_stage_ = B_ = P_ = zeros(s);
  M_next_ = minus_adjoints_ = Y_ = unknowns_[1];
  sum_ = skew_ = zeros(places(s));
  place_of_pair_.resize(stages() * stages());
  for (std::size_t p = 0; p < pairs_.order.size(); ++p) {
    const auto [j, k] = pairs_.order[p];
    place_of_pair_[k * stages() + j] = p;
    if (j < k) off_diagonal_.push_back(p);
  }
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
        solve_generator(i, W_stage_[i], B_[i], share, worker);
      },
      [&](std::size_t i, Share share, Worker&) {
        finish_generator(i, B_[i], share);
        reals(P_[i], share) = reals(W0_, share) + reals(X_sum_[i], share);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.planar.multiply(P_[i], B_[i], X_next_[i], -h, share);
      });
  in_phases(
      pairs_.items(),
      [&](std::size_t p, Share share, Worker&) {
        const auto [j, k] = pairs_.order[p];
        auto input = reals(Y_[p], share);
        input = reals(X_next_[k], share) + a(j, 0) * reals(M(0, k), share);
        for (std::size_t m = 1; m < stages(); ++m) input += a(j, m) * reals(M(m, k), share);
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
  const auto change = [&](std::size_t kind, const Stages& next) {
    const Stages& old = unknowns_[kind];
    in_halves_of(items_[kind], [&](std::size_t i, Share half) {
      half_of_squares(half)[i] = squared_change(next[i], old[i], half);
    });
    return largest_of_squares(static_cast<Index>(next.size()));
  };
  const double of_X = change(0, X_next_);
  const double of_M = change(1, M_next_);
  std::swap(unknowns_[0], X_next_);
  std::swap(unknowns_[1], M_next_);
  return larger(larger(of_X, of_M), update_stage_vorticities());
}

double FastAlgebra::residual(double h) {
  form_next(h);
  const auto difference = [&](std::size_t kind, const Stages& next) {
    in_halves_of(items_[kind], [&](std::size_t i, Share half) {
      half_of_squares(half)[i] = isosyrk::residual(
          unknowns_[kind][i], [&](const auto& load) { return load(next[i]); }, residuals_[kind][i],
          half);
    });
    return largest_of_squares(static_cast<Index>(next.size()));
  };
  const double of_X = difference(0, X_next_);
  const double of_M = difference(1, M_next_);
  return larger(larger(of_X, of_M), correct_stage_vorticities(residuals_[0], residuals_[1]));
}

Index FastAlgebra::linearise(double h, double accuracy) {
  in_halves_of(stages(), [&](std::size_t i, Share half) {
    narrow_generator(i, B_[i], h, accuracy, B_single_[i], half);
    narrow(P_[i], P_single_[i], half);
  });
  in_halves_of(pairs_.items(),
               [&](std::size_t p, Share half) { narrow(Y_[p], Y_single_[p], half); });
  return widest_band(B_single_);
}

// dW_: what corrections to X and M make of W̃; returns the largest.
double FastAlgebra::correct_stage_vorticities(const Singles& X, const Singles& M) {
  const auto weight = [&](std::size_t i, std::size_t j, std::size_t k) {
    return static_cast<float>(a(i, j) * a(i, k));
  };
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker&) {
        auto sum = reals(single_input_[i], share);
        sum = static_cast<float>(a(i, 0)) * reals(X[0], share);
        for (std::size_t k = 1; k < stages(); ++k) {
          sum += static_cast<float>(a(i, k)) * reals(X[k], share);
          for (std::size_t j = 0; j < k; ++j) {
            sum += weight(i, j, k) * reals(M[pair(j, k)], share);
          }
        }
      },
      [&](std::size_t i, Share share, Worker&) {
        skew_part(single_input_[i], 1.0f, dW_[i], share);
      },
      [&](std::size_t i, Share share, Worker&) {
        for_halves(share, [&](Share half) {
          auto dW = reals(dW_[i], half);
          for (std::size_t j = 0; j < stages(); ++j) {
            dW += weight(i, j, j) * reals(M[pair(j, j)], half);
          }
          half_of_squares(half)[i] = static_cast<double>(dW.square().sum());
        });
      });
  return largest_of_squares(static_cast<Index>(stages()));
}

double FastAlgebra::transport(double h) {
  Singles& delta = delta_[0];
  const auto step_of = static_cast<float>(h);
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker&) {
        combine(tableau_.a.row(static_cast<Index>(i)).cast<float>(), delta, single_input_[i],
                share);
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
      pairs_.items(),
      [&](std::size_t p, Share share, Worker&) {
        const auto [j, k] = pairs_.order[p];
        auto input = reals(single_input_[p], share);
        input = reals(delta[k], share) - reals(residuals_[0][k], share);
        for (std::size_t m = 0; m < stages(); ++m) {
          input += static_cast<float>(a(j, m)) * reals(epsilon(m, k), share);
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
  in_halves_of(items_[kind], [&](std::size_t i, Share half) {
    half_of_squares(half)[i] = replace(delta[i], half, [&](const auto& load) {
      return load(rhs_[kind][i]) + load(single_product_[i]);
    });
  });
  return largest_of_squares(static_cast<Index>(delta.size()));
}

void FastAlgebra::couple(double h) {
  const auto step_of = static_cast<float>(h);
  correct_stage_vorticities(delta_[0], delta_[1]);
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        solve_generator(dW_[i], dB_[i], share, worker);
      },
      [&](std::size_t i, Share share, Worker&) { finish_generator(dB_[i], share); },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.singles.multiply(P_single_[i], dB_[i], single_product_[i], -step_of, share);
      },
      [&](std::size_t i, Share share, Worker&) {
        reals(next_rhs_[0][i], share) =
            reals(residuals_[0][i], share) + reals(single_product_[i], share);
      });
  in_phases(
      pairs_.items(),
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.singles, p, dB_, Y_single_, single_product_, step_of, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(single_product_[p], share);
      },
      [&](std::size_t p, Share share, Worker&) {
        reals(next_rhs_[1][p], share) =
            reals(residuals_[1][p], share) + reals(single_product_[p], share);
      });
}

// W̃_i, and what else the next sweep takes, from the unknowns; returns the largest change of W̃_i.
double FastAlgebra::update_stage_vorticities() {
  const std::size_t s = stages();
  in_phases(off_diagonal_.size(), [&](std::size_t which, Share share, Worker&) {
    const std::size_t p = off_diagonal_[which];
    minus_adjoint(unknowns_[1][p], minus_adjoints_[p], share);
  });
  const auto S = [&](std::size_t i) -> PlanarMatrix& { return s > 1 ? sum_[place(i)] : X_sum_[i]; };
  in_phases(
      s,
      [&](std::size_t i, Share share, Worker&) {
        combine(tableau_.a.row(static_cast<Index>(i)), unknowns_[0], X_sum_[i], share);
        if (s == 1) return;
        auto sum = reals(S(i), share);
        sum = reals(X_sum_[i], share) + a(i, 0) * a(i, 1) * reals(M(0, 1), share);
        for (std::size_t k = 2; k < s; ++k) {
          for (std::size_t j = 0; j < k; ++j) sum += a(i, j) * a(i, k) * reals(M(j, k), share);
        }
      },
      [&](std::size_t i, Share share, Worker&) { skew_part(S(i), 1.0, skew_[place(i)], share); },
      [&](std::size_t i, Share share, Worker&) {
        PlanarMatrix& skew = skew_[place(i)];
        const double first = a(i, 0) * a(i, 0);
        for_halves(share, [&](Share half) {
          for (std::size_t j = 1; j < s; ++j) {
            reals(skew, half) += a(i, j) * a(i, j) * reals(M(j, j), half);
          }
          half_of_squares(half)[i] = replace(W_stage_[i], half, [&](const auto& load) {
            return load(W0_) + load(skew) + first * load(M(0, 0));
          });
        });
      });
  return largest_of_squares(static_cast<Index>(s));
}

void FastAlgebra::update(double h, PlanarMatrix& W1) {
  Stages& C = X_next_;
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker& worker) {
        solve_generator(i, W_stage_[i], B_[i], share, worker);
      },
      [&](std::size_t i, Share share, Worker&) { finish_generator(i, B_[i], share); },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.planar.multiply(B_[i], W_stage_[i], C[i], 1.0, share);
      });
  in_phases(
      1, [&](std::size_t, Share share, Worker&) { combine(h * tableau_.b, C, sum_[0], share); },
      [&](std::size_t, Share share, Worker&) { skew_part(sum_[0], 1.0, skew_[0], share); },
      [&](std::size_t, Share share, Worker&) {
        reals(W1, share) = reals(W0_, share) + reals(skew_[0], share);
      });
}

}  // namespace isosyrk
