#include "core/fast_group.h"

#include "core/stage_sums.h"

namespace isosyrk {

FastGroup::FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options)
    : FastForm(flow, options, {tableau.stages()}), tableau_(tableau) {
  require_consistent(tableau);
  W0Q_ = W_stage_ = B_ = Q1_ = zero();
  QB_ = zeros(tableau.stages());
  identity_ = identity();
  change_.resize(tableau.stages());
}

void FastGroup::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
}

// W = Q† W₀ Q
void FastGroup::transport(const PlanarMatrix& Q, PlanarMatrix& W) {
  planar_.multiply(W0_, Q, W0Q_);
  planar_.multiply_adjoint_left_skew(Q, W0Q_, W);
}

double FastGroup::sweep(double h) {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  for (std::size_t j = 0; j < Q.size(); ++j) {
    transport(Q[j], W_stage_);
    generator(W_stage_, B_);
    planar_.multiply(Q[j], B_, QB_[j]);
  }
  update_unknowns(identity_, -h, tableau_.a, QB_, Q, change_.data());
  return largest_change(change_);
}

void FastGroup::update(double h, PlanarMatrix& W1) {
  combine(identity_, -h * tableau_.b, QB_, Q1_);
  transport(Q1_, W1);
}

}  // namespace isosyrk
