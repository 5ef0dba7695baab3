#include "isosyrk/integrators/group_form.h"

namespace isosyrk {

GroupForm::GroupForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                     ProductBackend backend)
    : ImplicitForm(flow, options, backend), tableau_(tableau) {
  require_consistent(tableau);
  const Index n = flow.size();
  Q_ = stage_matrices(tableau.stages(), n);
  QB_ = Q_;
  W_stage_ = B_ = W0Q_ = Q_next_ = Matrix::Zero(n, n);
  if (!flow.algebra().is_skew_hermitian()) JQ_ = Matrix::Zero(n, n);
  identity_ = Matrix::Identity(n, n);
  change_.resize(tableau.stages());
}

// W = Q† W₀ J Q J⁻¹
void GroupForm::transport(const Matrix& W0, const Matrix& Q, Matrix& W) {
  const QuadraticAlgebra& algebra = flow().algebra();
  if (algebra.is_skew_hermitian()) {
    products_.multiply(W0, Q, W0Q_);
  } else {
    algebra.conjugate_by_J(Q, JQ_);
    products_.multiply(W0, JQ_, W0Q_);
  }
  products_.multiply_adjoint_left(Q, W0Q_, W);
}

// QB_j = Q_j B(W̃_j)† from the current Q_j.
void GroupForm::evaluate_stages(const Matrix& W0) {
  for (std::size_t j = 0; j < Q_.size(); ++j) {
    transport(W0, Q_[j], W_stage_);
    generator(W_stage_, B_);
    products_.multiply_adjoint_right(Q_[j], B_, QB_[j]);
  }
}

double GroupForm::sweep(const Matrix& W0, double h) {
  evaluate_stages(W0);
  update_unknowns(identity_, h, tableau_.a, QB_, Q_, change_.data());
  return largest_change(change_);
}

void GroupForm::start(const Matrix&) {
  for (Matrix& Q : Q_) Q.setIdentity();
}

void GroupForm::update(const Matrix& W0, double h, Matrix& W1) {
  evaluate_stages(W0);
  combine(identity_, h * tableau_.b, QB_, Q_next_);
  transport(W0, Q_next_, W1);
}

}  // namespace isosyrk
