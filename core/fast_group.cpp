#include "core/fast_group.h"

#include "core/euler_zeitlin.h"
#include "core/stage_sums.h"

namespace isosyrk {

FastGroup::FastGroup(const EulerZeitlin& flow, const Tableau& tableau, const FastOptions& options)
    : FastForm(flow, options, {tableau.stages()}), tableau_(tableau) {
  require_consistent(tableau);
  W0Q_ = W_stage_ = Q1_ = zero();
  B_ = QB_ = zeros(tableau.stages());
  identity_ = identity();
  change_.resize(tableau.stages());
  tolerance_ = options.solver.tolerance;
  constexpr Index smallest = 48;  // below, the second transport saves less than it costs (measured)
  transports_twice_ = flow.size() >= smallest;
}

void FastGroup::start_cold() {
  for (PlanarMatrix& Q : unknowns_[0]) Q.entries() = identity_.entries();
}

// W = Q† W₀ Q
void FastGroup::conjugate(const PlanarMatrix& Q, PlanarMatrix& W) {
  planar_.multiply(W0_, Q, W0Q_);
  planar_.multiply_adjoint_left_skew(Q, W0Q_, W);
}

// Q_i = I - h Σ_j a_ij Q_j B_j; returns the largest change.
double FastGroup::transport(double h) {
  std::vector<PlanarMatrix>& Q = unknowns_[0];
  for (std::size_t j = 0; j < Q.size(); ++j) planar_.multiply(Q[j], B_[j], QB_[j]);
  update_unknowns(identity_, -h, tableau_.a, QB_, Q, change_.data());
  return largest_change(change_);
}

double FastGroup::sweep(double h) {
  for (std::size_t j = 0; j < B_.size(); ++j) {
    conjugate(unknowns_[0][j], W_stage_);
    generator(W_stage_, B_[j]);
  }
  const double change = transport(h);
  if (transports_twice_ && change >= tolerance_) transport(h);
  return change;
}

void FastGroup::update(double h, PlanarMatrix& W1) {
  combine(identity_, -h * tableau_.b, QB_, Q1_);
  conjugate(Q1_, W1);
}

}  // namespace isosyrk
