#include "isosyrk/integrators/direct_form.h"

namespace isosyrk {

template <class Scalar>
DirectForm<Scalar>::DirectForm(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                               const IterationOptions& options, ProductBackend backend)
    : Form(std::move(flow), options, backend), tableau_(tableau) {
  require_consistent(tableau);
  W_stage_ = zeros(tableau.stages());
  C_ = W_stage_;
  B_ = sum_ = fresh_ = zero();
  change_.resize(tableau.stages());
  scratch_ = scratch_of_J();
}

template <class Scalar>
void DirectForm<Scalar>::evaluate_stages() {
  for (std::size_t i = 0; i < W_stage_.size(); ++i) {
    generator(W_stage_[i], B_);
    products_.multiply(B_, W_stage_[i], C_[i]);
  }
}

template <class Scalar>
double DirectForm<Scalar>::sweep(const Stored& W0, double h) {
  evaluate_stages();
  for (Index i = 0; i < tableau_.stages(); ++i) {
    Stored& W = W_stage_[static_cast<std::size_t>(i)];
    add_increment(W0, h * tableau_.a.row(i).transpose(), fresh_);
    change_(i) = squared_change(fresh_, W);
    W.swap(fresh_);
  }
  return largest_change(change_);
}

// out = W₀ + Σ_j weights_j [B_j, W̃_j]
template <class Scalar>
template <class Weights>
void DirectForm<Scalar>::add_increment(const Stored& W0, const Weights& weights, Stored& out) {
  combine(weights, C_, sum_);
  add_commutator(algebra(), W0, sum_, scratch_, out);
}

template <class Scalar>
void DirectForm<Scalar>::start(const Stored& W0) {
  for (Stored& W : W_stage_) W = W0;
}

template <class Scalar>
void DirectForm<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  evaluate_stages();
  add_increment(W0, h * tableau_.b, W1);
}

template class DirectForm<double>;
template class DirectForm<Complex>;

}  // namespace isosyrk
