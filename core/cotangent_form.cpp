#include "core/cotangent_form.h"

#include "core/stage_sums.h"

namespace isosyrk {

CotangentForm::CotangentForm(const Flow& flow, const Tableau& tableau,
                             const SolverOptions& options, ProductBackend backend)
    : Integrator(flow, backend), tableau_(tableau), options_(options) {
  require_consistent(tableau);
  const Index n = flow.size();
  Q_ = stage_matrices(tableau.stages(), n);
  P_ = QB_ = PB_ = Q_;
  W_stage_ = B_ = Q_next_ = P_next_ = Matrix::Zero(n, n);
  row_.resize(2 * n);
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
  Row fresh(row_.data(), row_.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < Q_.size(); ++i) {
    const auto a_i = h * tableau_.a.row(static_cast<Index>(i)).array();
    double change_Q = 0.0;
    double change_P = 0.0;
    for (Index r = 0; r < flow_.size(); ++r) {
      combine_row(a_i, QB_.data(), r, fresh);
      fresh(2 * r) += 1.0;  // the identity
      Row old_Q = row(Q_[i], r);
      change_Q += squared_change(fresh, old_Q);
      old_Q = fresh;

      combine_row(a_i, PB_.data(), r, fresh);
      fresh = row(W0, r) - fresh;
      Row old_P = row(P_[i], r);
      change_P += squared_change(fresh, old_P);
      old_P = fresh;
    }
    largest = larger(largest, larger(change_Q, change_P));
  }
  return std::sqrt(largest);
}

SolveReport CotangentForm::advance(const Matrix& W0, double h, Matrix& W1) {
  for (Matrix& Q : Q_) Q.setIdentity();
  for (Matrix& P : P_) P = W0;
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  evaluate_stages();
  const auto b = h * tableau_.b.array();
  Row sum(row_.data(), row_.size());
  for (Index r = 0; r < flow_.size(); ++r) {
    combine_row(b, QB_.data(), r, sum);
    row(Q_next_, r) = sum;
    Q_next_(r, r) += 1.0;
    combine_row(b, PB_.data(), r, sum);
    row(P_next_, r) = row(W0, r) - sum;
  }
  products_.multiply_adjoint_left(Q_next_, P_next_, W1);
  return report;
}

}  // namespace isosyrk
