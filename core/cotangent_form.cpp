#include "core/cotangent_form.h"

#include "core/stage_sums.h"

namespace isosyrk {

CotangentForm::CotangentForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                             ProductBackend backend)
    : Integrator(flow, backend), tableau_(tableau), options_(options) {
  require_consistent(tableau);
  const Index n = flow.size();
  Q_ = stage_matrices(tableau.stages(), n);
  P_ = QB_ = PB_ = Q_;
  W_stage_ = B_ = Q_next_ = P_next_ = Matrix::Zero(n, n);
  change_.resize(2 * tableau.stages());
}

// QB_j = Q_j B(W̃_j)† and PB_j = P_j B(W̃_j) from the present Q_j, P_j.
void CotangentForm::evaluate_stages() {
  for (std::size_t j = 0; j < Q_.size(); ++j) {
    products_.multiply_adjoint_left(Q_[j], P_[j], W_stage_);
    generator(W_stage_, B_);
    products_.multiply_adjoint_right(Q_[j], B_, QB_[j]);
    products_.multiply(P_[j], B_, PB_[j]);
  }
}

double CotangentForm::sweep(const Matrix& W0, double h) {
  evaluate_stages();
  const Index n = flow_.size();
  change_.setZero();
  for_each_block(n, [&](Block block) {
    Entries fresh = block_.entries(block);
    for (Index i = 0; i < tableau_.stages(); ++i) {
      const auto a_i = h * tableau_.a.row(i).array();
      combine(a_i, QB_.data(), block, fresh);
      add_identity(fresh, n, block);
      Entries Q = entries(Q_[static_cast<std::size_t>(i)], block);
      change_(2 * i) += squared_change(fresh, Q);
      Q = fresh;

      combine(a_i, PB_.data(), block, fresh);
      fresh = entries(W0, block) - fresh;
      Entries P = entries(P_[static_cast<std::size_t>(i)], block);
      change_(2 * i + 1) += squared_change(fresh, P);
      P = fresh;
    }
  });
  return largest_change(change_);
}

SolveReport CotangentForm::advance(const Matrix& W0, double h, Matrix& W1) {
  for (Matrix& Q : Q_) Q.setIdentity();
  for (Matrix& P : P_) P = W0;
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  evaluate_stages();
  const auto b = h * tableau_.b.array();
  for_each_block(flow_.size(), [&](Block block) {
    Entries Q = entries(Q_next_, block);
    combine(b, QB_.data(), block, Q);
    add_identity(Q, flow_.size(), block);
    Entries P = entries(P_next_, block);
    combine(b, PB_.data(), block, P);
    P = entries(W0, block) - P;
  });
  products_.multiply_adjoint_left(Q_next_, P_next_, W1);
  return report;
}

}  // namespace isosyrk
