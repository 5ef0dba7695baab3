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
  row_.resize(2 * n);
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
  Row fresh(row_.data(), row_.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < Q_.size(); ++i) {
    const auto a_i = h * tableau_.a.row(static_cast<Index>(i)).array();
    double change = 0.0;
    for (Index r = 0; r < flow_.size(); ++r) {
      combine_row(a_i, QB_.data(), r, fresh);
      fresh(2 * r) += 1.0;  // the identity
      Row old = row(Q_[i], r);
      change += squared_change(fresh, old);
      old = fresh;
    }
    largest = larger(largest, change);
  }
  return std::sqrt(largest);
}

SolveReport GroupForm::advance(const Matrix& W0, double h, Matrix& W1) {
  for (Matrix& Q : Q_) Q.setIdentity();
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  evaluate_stages(W0);
  const auto b = h * tableau_.b.array();
  for (Index r = 0; r < flow_.size(); ++r) {
    Row fresh = row(Q_next_, r);
    combine_row(b, QB_.data(), r, fresh);
    fresh(2 * r) += 1.0;
  }
  transport(W0, Q_next_, W1);
  return report;
}

}  // namespace isosyrk
