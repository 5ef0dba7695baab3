#include "core/group_form.h"

#include "core/stage_sums.h"

namespace isosyrk {

GroupForm::GroupForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                     ProductBackend backend)
    : Integrator(flow, backend), tableau_(tableau), options_(options) {
  require_consistent(tableau);
  const Index n = flow.size();
  Q_ = stage_matrices(tableau.stages(), n);
  QB_ = Q_;
  W_stage_ = B_ = W0Q_ = Q_next_ = Matrix::Zero(n, n);
  if (!flow.algebra().is_skew_hermitian()) JQ_ = Matrix::Zero(n, n);
  change_.resize(tableau.stages());
}

// W = Q† W₀ J Q J⁻¹
void GroupForm::transport(const Matrix& W0, const Matrix& Q, Matrix& W) {
  const QuadraticAlgebra& algebra = flow_.algebra();
  if (algebra.is_skew_hermitian()) {
    products_.multiply(W0, Q, W0Q_);
  } else {
    algebra.conjugate_by_J(Q, JQ_);
    products_.multiply(W0, JQ_, W0Q_);
  }
  products_.multiply_adjoint_left(Q, W0Q_, W);
}

// QB_j = Q_j B(W̃_j)† from the present Q_j.
void GroupForm::evaluate_stages(const Matrix& W0) {
  for (std::size_t j = 0; j < Q_.size(); ++j) {
    transport(W0, Q_[j], W_stage_);
    generator(W_stage_, B_);
    products_.multiply_adjoint_right(Q_[j], B_, QB_[j]);
  }
}

double GroupForm::sweep(const Matrix& W0, double h) {
  evaluate_stages(W0);
  const Index n = flow_.size();
  change_.setZero();
  for_each_block(n, [&](Block block) {
    Entries fresh = block_.entries(block);
    for (Index i = 0; i < tableau_.stages(); ++i) {
      combine(h * tableau_.a.row(i).array(), QB_.data(), block, fresh);
      add_identity(fresh, n, block);
      Entries Q = entries(Q_[static_cast<std::size_t>(i)], block);
      change_(i) += squared_change(fresh, Q);
      Q = fresh;
    }
  });
  return largest_change(change_);
}

SolveReport GroupForm::advance(const Matrix& W0, double h, Matrix& W1) {
  for (Matrix& Q : Q_) Q.setIdentity();
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  evaluate_stages(W0);
  for_each_block(flow_.size(), [&](Block block) {
    Entries Q = entries(Q_next_, block);
    combine(h * tableau_.b.array(), QB_.data(), block, Q);
    add_identity(Q, flow_.size(), block);
  });
  transport(W0, Q_next_, W1);
  return report;
}

}  // namespace isosyrk
