#include "core/direct_form.h"

#include "core/commutator_update.h"
#include "core/stage_sums.h"

namespace isosyrk {

DirectForm::DirectForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                       ProductBackend backend)
    : Integrator(flow, backend), tableau_(tableau), options_(options) {
  require_consistent(tableau);
  const Index n = flow.size();
  W_stage_ = stage_matrices(tableau.stages(), n);
  C_ = W_stage_;
  B_ = sum_ = fresh_ = Matrix::Zero(n, n);
  if (!flow.algebra().is_skew_hermitian()) scratch_ = Matrix::Zero(n, n);
}

void DirectForm::evaluate_stages() {
  for (std::size_t i = 0; i < W_stage_.size(); ++i) {
    generator(W_stage_[i], B_);
    products_.multiply(B_, W_stage_[i], C_[i]);
  }
}

double DirectForm::sweep(const Matrix& W0, double h) {
  evaluate_stages();
  double largest = 0.0;
  for (std::size_t i = 0; i < W_stage_.size(); ++i) {
    const auto a_i = h * tableau_.a.row(static_cast<Index>(i)).array();
    for (Index r = 0; r < flow_.size(); ++r) combine_row(a_i, C_.data(), r, row(sum_, r));
    add_commutator(flow_.algebra(), W0, sum_, scratch_, fresh_);
    double change = 0.0;
    for (Index r = 0; r < flow_.size(); ++r) {
      change += squared_change(row(fresh_, r), row(W_stage_[i], r));
    }
    largest = larger(largest, change);
    W_stage_[i].swap(fresh_);
  }
  return std::sqrt(largest);
}

SolveReport DirectForm::advance(const Matrix& W0, double h, Matrix& W1) {
  for (Matrix& W : W_stage_) W = W0;
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status != Status::converged) return report;

  evaluate_stages();
  const auto b = h * tableau_.b.array();
  for (Index r = 0; r < flow_.size(); ++r) combine_row(b, C_.data(), r, row(sum_, r));
  add_commutator(flow_.algebra(), W0, sum_, scratch_, W1);
  return report;
}

}  // namespace isosyrk
