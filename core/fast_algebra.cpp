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
  input_ = skew_ = zero();
}

void FastAlgebra::start_cold() {
  for (Stages& kind : unknowns_) {
    for (PlanarMatrix& unknown : kind) unknown.entries().setZero();
  }
}

void FastAlgebra::begin() { update_stage_vorticities(); }

double FastAlgebra::sweep(double h) {
  const std::size_t s = stages();
  Stages& X = unknowns_[0];
  double change = 0.0;
  for (std::size_t i = 0; i < s; ++i) generator(W_stage_[i], B_[i]);
  for (std::size_t i = 0; i < s; ++i) {
    reals(input_) = reals(W0_) + reals(X_sum_[i]);
    planar_.multiply(input_, B_[i], X_next_[i], -h);
    change = larger(change, squared_change(X_next_[i], X[i]));
  }
  std::swap(X, X_next_);
  for (std::size_t k = 0; k < s; ++k) {
    for (std::size_t j = 0; j <= k; ++j) {
      reals(input_) = reals(X[k]) + a(j, 0) * reals(M(0, k));
      for (std::size_t m = 1; m < s; ++m) reals(input_) += a(j, m) * reals(M(m, k));
      PlanarMatrix& fresh = M_next_[pair(j, k)];
      if (j == k) {
        planar_.multiply_skew(B_[j], input_, fresh, h);
      } else {
        planar_.multiply(B_[j], input_, fresh, h);
      }
      change = larger(change, squared_change(fresh, M(j, k)));
    }
  }
  std::swap(unknowns_[1], M_next_);
  return std::sqrt(larger(change, update_stage_vorticities()));
}

// W̃_i, and what else the next sweep takes, from the unknowns; returns the largest squared change.
double FastAlgebra::update_stage_vorticities() {
  const std::size_t s = stages();
  double change = 0.0;
  for (std::size_t k = 0; k < s; ++k) {
    for (std::size_t j = 0; j < k; ++j) minus_adjoint(M(j, k), minus_adjoints_[pair(j, k)]);
  }
  for (std::size_t i = 0; i < s; ++i) {
    combine(tableau_.a.row(static_cast<Index>(i)), unknowns_[0], X_sum_[i]);
    const PlanarMatrix* S = &X_sum_[i];
    if (s > 1) {
      reals(input_) = reals(X_sum_[i]) + a(i, 0) * a(i, 1) * reals(M(0, 1));
      for (std::size_t k = 2; k < s; ++k) {
        for (std::size_t j = 0; j < k; ++j) reals(input_) += a(i, j) * a(i, k) * reals(M(j, k));
      }
      S = &input_;
    }
    skew_part(*S, 1.0, skew_);
    for (std::size_t j = 1; j < s; ++j) reals(skew_) += a(i, j) * a(i, j) * reals(M(j, j));
    const double first = a(i, 0) * a(i, 0);
    change = larger(change, replace(W_stage_[i], [&](const auto& load) {
                      return load(W0_) + load(skew_) + first * load(M(0, 0));
                    }));
  }
  return change;
}

void FastAlgebra::update(double h, PlanarMatrix& W1) {
  Stages& C = X_next_;
  for (std::size_t i = 0; i < stages(); ++i) {
    generator(W_stage_[i], B_[i]);
    planar_.multiply(B_[i], W_stage_[i], C[i]);
  }
  combine(h * tableau_.b, C, input_);
  skew_part(input_, 1.0, skew_);
  W1.entries() = W0_.entries() + skew_.entries();
}

}  // namespace isosyrk
