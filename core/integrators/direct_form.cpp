#include "isosyrk/integrators/direct_form.h"

namespace isosyrk {

DirectForm::DirectForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                       ProductBackend backend)
    : ImplicitForm(flow, options, backend), tableau_(tableau) {
  require_consistent(tableau);
  const Index n = flow.size();
  W_stage_ = stage_matrices(tableau.stages(), n);
  C_ = W_stage_;
  B_ = sum_ = fresh_ = Matrix::Zero(n, n);
  change_.resize(tableau.stages());
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
  for (Index i = 0; i < tableau_.stages(); ++i) {
    Matrix& W = W_stage_[static_cast<std::size_t>(i)];
    add_increment(W0, h * tableau_.a.row(i).transpose(), fresh_);
    change_(i) = squared_change(fresh_, W);
    W.swap(fresh_);
  }
  return largest_change(change_);
}

// out = W₀ + Σ_j weights_j [B_j, W̃_j]
template <class Weights>
void DirectForm::add_increment(const Matrix& W0, const Weights& weights, Matrix& out) {
  combine(weights, C_, sum_);
  add_commutator(flow().algebra(), W0, sum_, scratch_, out);
}

void DirectForm::start(const Matrix& W0) {
  for (Matrix& W : W_stage_) W = W0;
}

void DirectForm::update(const Matrix& W0, double h, Matrix& W1) {
  evaluate_stages();
  add_increment(W0, h * tableau_.b, W1);
}

}  // namespace isosyrk
