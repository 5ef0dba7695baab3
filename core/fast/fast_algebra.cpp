#include "isosyrk/fast/fast_algebra.h"

#include <algorithm>
#include <utility>

#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/split/mixed_sums.h"
#include "isosyrk/split/split_blocks.h"

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
               std::max<Index>(32, 3 * flow.size() / 8)),
      tableau_(tableau),
      pairs_(std::move(pairs)) {
  require_consistent(tableau);
  const Index s = tableau.stages();
  X_sum_ = W_stage_ = B_ = P_ = zeros(s);
  next_ = unknowns_;
  Y_ = unknowns_[1];
  sum_ = skew_ = zeros(places(s));
  place_of_pair_.resize(stages() * stages());
  for (std::size_t p = 0; p < pairs_.order.size(); ++p) {
    const auto [j, k] = pairs_.order[p];
    place_of_pair_[k * stages() + j] = p;
  }
  B_single_ = P_single_ = dW_ = dB_ = singles(s);
  Y_single_ = single_input_ = residuals_[1];
  next_delta_ = residuals_;
}

void FastAlgebra::start_cold() {
  for (Stages& kind : unknowns_) {
    for (PlanarMatrix& unknown : kind) unknown.entries().setZero();
  }
}

void FastAlgebra::begin() { update_stage_vorticities(); }

// next_, M from X; returns the largest of what change(kind, item, half) says, the squared change of
// half an unknown.
template <class Change>
double FastAlgebra::form_next(double h, Change&& change) {
  Stages& X = next_[0];
  Stages& M = next_[1];
  const auto note_change = [&](std::size_t kind, std::size_t item, Share share) {
    for_halves(share, [&](Share half) { half_of_squares(half)[item] = change(kind, item, half); });
  };
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
        worker.planar.multiply(P_[i], B_[i], X[i], -h, share);
      },
      [&](std::size_t i, Share share, Worker&) { note_change(0, i, share); });
  const double of_X = largest_of_squares(static_cast<Index>(X.size()));
  in_phases(
      pairs_.items(),
      [&](std::size_t p, Share share, Worker&) {
        Terms<double> terms;
        terms.add(1.0, X[pairs_.order[p].second]);
        set_pair_sum(p, terms, unknowns_[1], Y_[p], share);
      },
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.planar, p, B_, Y_, M, h, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(M[p], share);
      },
      [&](std::size_t p, Share share, Worker&) { note_change(1, p, share); });
  return larger(of_X, largest_of_squares(static_cast<Index>(M.size())));
}

double FastAlgebra::sweep(double h) {
  const double change = form_next(h, [&](std::size_t kind, std::size_t item, Share half) {
    return squared_change(next_[kind][item], unknowns_[kind][item], half);
  });
  std::swap(unknowns_, next_);
  return larger(change, update_stage_vorticities());
}

double FastAlgebra::residual(double h) {
  const double change = form_next(h, [&](std::size_t kind, std::size_t item, Share half) {
    return isosyrk::residual(
        unknowns_[kind][item], [&](const auto& load) { return load(next_[kind][item]); },
        residuals_[kind][item], half);
  });
  return larger(change, correct_stage_vorticities(residuals_[0], residuals_[1]));
}

Index FastAlgebra::linearise(double h, double accuracy) {
  in_halves_of_unknowns([&](std::size_t kind, std::size_t item, Share half) {
    if (kind == 0) {
      narrow_generator(item, B_[item], h, accuracy, B_single_[item], half);
      narrow(P_[item], P_single_[item], half);
    } else {
      narrow(Y_[item], Y_single_[item], half);
    }
    start_correction(kind, item, half);
  });
  return widest_band(B_single_);
}

// dW_: what corrections to X and M make of W̃, and then each phase of its stages; returns the
// largest dW_, or what the last phase leaves to be read.
template <class... Phases>
double FastAlgebra::correct_stage_vorticities(const Singles& X, const Singles& M,
                                              Phases&&... phases) {
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker&) {
        Terms<float> terms;
        for (std::size_t k = 0; k < stages(); ++k) {
          terms.add(a(i, k), X[k]);
          for (std::size_t j = 0; j < k; ++j) terms.add(a(i, j) * a(i, k), M[pair(j, k)]);
        }
        assign(single_input_[i], share, terms);
      },
      [&](std::size_t i, Share share, Worker&) {
        skew_part(single_input_[i], 1.0f, dW_[i], share);
      },
      [&](std::size_t i, Share share, Worker&) {
        Terms<float> terms;
        terms.add(1.0, dW_[i]);
        for (std::size_t j = 0; j < stages(); ++j) terms.add(a(i, j) * a(i, j), M[pair(j, j)]);
        for_halves(share, [&](Share half) {
          assign(dW_[i], half, terms);
          half_of_squares(half)[i] = static_cast<double>(reals(dW_[i], half).square().sum());
        });
      },
      phases...);
  return largest_of_squares(static_cast<Index>(stages()));
}

double FastAlgebra::transport(double h) {
  const auto step_of = static_cast<float>(h);
  in_phases(
      stages(),
      [&](std::size_t i, Share share, Worker&) {
        combine(tableau_.a.row(static_cast<Index>(i)).cast<float>(), delta_[0], single_input_[i],
                share);
      },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.singles.multiply(single_input_[i], B_single_[i], next_delta_[0][i], -step_of, share);
      },
      [&](std::size_t i, Share share, Worker&) { add_rhs(0, i, share); });
  const double of_X = take_next_delta(0);
  in_phases(
      pairs_.items(),
      [&](std::size_t p, Share share, Worker&) {
        const std::size_t k = pairs_.order[p].second;
        Terms<float> terms;
        terms.add(1.0, delta_[0][k]);
        terms.add(-1.0, residuals_[0][k]);
        set_pair_sum(p, terms, delta_[1], single_input_[p], share);
      },
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.singles, p, B_single_, single_input_, next_delta_[1], step_of, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(next_delta_[1][p], share);
      },
      [&](std::size_t p, Share share, Worker&) { add_rhs(1, p, share); });
  return larger(of_X, take_next_delta(1));
}

// Makes of a product in next_delta_ what δ becomes.
void FastAlgebra::add_rhs(std::size_t kind, std::size_t item, Share share) {
  SingleMatrix& next = next_delta_[kind][item];
  for_halves(share, [&](Share half) {
    half_of_squares(half)[item] = replace(delta_[kind][item], next, half, [&](const auto& load) {
      return load(rhs_[kind][item]) + load(next);
    });
  });
}

double FastAlgebra::take_next_delta(std::size_t kind) {
  std::swap(delta_[kind], next_delta_[kind]);
  return largest_of_squares(static_cast<Index>(delta_[kind].size()));
}

double FastAlgebra::couple(double h) {
  const auto step_of = static_cast<float>(h);
  Singles& product_X = next_delta_[0];
  Singles& product_M = next_delta_[1];
  const double of_X = correct_stage_vorticities(
      delta_[0], delta_[1],
      [&](std::size_t i, Share share, Worker& worker) {
        solve_generator(dW_[i], dB_[i], share, worker);
      },
      [&](std::size_t i, Share share, Worker&) { finish_generator(dB_[i], share); },
      [&](std::size_t i, Share share, Worker& worker) {
        worker.singles.multiply(P_single_[i], dB_[i], product_X[i], -step_of, share);
      },
      [&](std::size_t i, Share share, Worker&) {
        couple_with(0, i, product_X[i], product_X[i], share);
      });
  std::swap(delta_[0], next_delta_[0]);
  in_phases(
      pairs_.items(),
      [&](std::size_t p, Share share, Worker& worker) {
        multiply_pair(worker.singles, p, dB_, Y_single_, product_M, step_of, share);
      },
      [&](std::size_t p, Share share, Worker&) {
        if (is_diagonal(p)) mirror_skew(product_M[p], share);
      },
      [&](std::size_t p, Share share, Worker&) {
        couple_with(1, p, product_M[p], delta_[1][p], share);
      });
  return larger(of_X, largest_of_squares(static_cast<Index>(product_M.size())));
}

// W̃_i, and what else the next sweep takes, from the unknowns; returns the largest change of W̃_i.
double FastAlgebra::update_stage_vorticities() {
  const std::size_t s = stages();
  const Stages& M = unknowns_[1];
  const auto S = [&](std::size_t i) -> PlanarMatrix& { return s > 1 ? sum_[place(i)] : X_sum_[i]; };
  in_phases(
      s,
      [&](std::size_t i, Share share, Worker&) {
        combine(tableau_.a.row(static_cast<Index>(i)), unknowns_[0], X_sum_[i], share);
        if (s == 1) return;
        Terms<double> terms;
        terms.add(1.0, X_sum_[i]);
        for (std::size_t k = 1; k < s; ++k) {
          for (std::size_t j = 0; j < k; ++j) terms.add(a(i, j) * a(i, k), M[pair(j, k)]);
        }
        assign(S(i), share, terms);
      },
      [&](std::size_t i, Share share, Worker&) { skew_part(S(i), 1.0, skew_[place(i)], share); },
      [&](std::size_t i, Share share, Worker&) {
        Terms<double> terms;
        terms.add(1.0, W0_);
        terms.add(1.0, skew_[place(i)]);
        for (std::size_t j = 0; j < s; ++j) terms.add(a(i, j) * a(i, j), M[pair(j, j)]);
        for_halves(share, [&](Share half) {
          half_of_squares(half)[i] = replace(W_stage_[i], half, terms);
        });
      });
  return largest_of_squares(static_cast<Index>(s));
}

void FastAlgebra::update(double h, PlanarMatrix& W1) {
  Stages& C = next_[0];
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
