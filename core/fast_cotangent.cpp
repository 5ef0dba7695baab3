#include "core/fast_cotangent.h"

#include "core/stage_sums.h"

namespace isosyrk {

FastCotangent::FastCotangent(const EulerZeitlin& flow, const Tableau& tableau,
                             const FastOptions& options)
    : FastForm(flow, options, {tableau.stages(), tableau.stages()}), tableau_(tableau) {
  require_consistent(tableau);
  W_stage_ = B_ = Q1_ = P1_ = zero();
  QB_ = PB_ = zeros(tableau.stages());
  identity_ = identity();
  change_.resize(2 * tableau.stages());
}

void FastCotangent::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
  for (PlanarMatrix& P : unknowns_[1]) P.entries() = W0_.entries();
}

double FastCotangent::sweep(double h) {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  std::vector<PlanarMatrix>& P = unknowns_[1];
  for (std::size_t j = 0; j < Q.size(); ++j) {
    planar_.multiply_adjoint_left_skew(Q[j], P[j], W_stage_);
    generator(W_stage_, B_);
    planar_.multiply(Q[j], B_, QB_[j]);
    planar_.multiply(P[j], B_, PB_[j]);
  }
  update_unknowns(identity_, -h, tableau_.a, QB_, Q, change_.data());
  update_unknowns(W0_, -h, tableau_.a, PB_, P, change_.data() + tableau_.stages());
  return largest_change(change_);
}

void FastCotangent::update(double h, PlanarMatrix& W1) {
  combine(identity_, -h * tableau_.b, QB_, Q1_);
  combine(W0_, -h * tableau_.b, PB_, P1_);
  planar_.multiply_adjoint_left_skew(Q1_, P1_, W1);
}

}  // namespace isosyrk
