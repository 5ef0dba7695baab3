#include "isosyrk/integrators/group_form.h"

namespace isosyrk {

template <class Scalar>
GroupForm<Scalar>::GroupForm(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                             const IterationOptions& options, ProductBackend backend)
    : Form(std::move(flow), options, backend), tableau_(tableau) {
  require_consistent(tableau);
  Q_ = zeros(tableau.stages());
  QB_ = Q_;
  W_stage_ = B_ = W0Q_ = Q_next_ = zero();
  JQ_ = scratch_of_J();
  identity_ = identity();
  change_.resize(tableau.stages());
}

// W = Q† W₀ J Q J⁻¹
template <class Scalar>
void GroupForm<Scalar>::transport(const Stored& W0, const Stored& Q, Stored& W) {
  if (algebra().is_skew_hermitian()) {
    products_.congruence(Q, W0, Q, W0Q_, W);
  } else {
    algebra().conjugate_by_J(Q, JQ_);
    products_.congruence(Q, W0, JQ_, W0Q_, W);
  }
}

// QB_j = Q_j B(W̃_j)† from the current Q_j.
template <class Scalar>
void GroupForm<Scalar>::evaluate_stages(const Stored& W0) {
  for (std::size_t j = 0; j < Q_.size(); ++j) {
    transport(W0, Q_[j], W_stage_);
    generator(W_stage_, B_);
    products_.multiply_adjoint_right(Q_[j], B_, QB_[j]);
  }
}

template <class Scalar>
double GroupForm<Scalar>::sweep(const Stored& W0, double h) {
  evaluate_stages(W0);
  update_unknowns(identity_, h, tableau_.a, QB_, Q_, change_.data());
  return largest_change(change_);
}

template <class Scalar>
void GroupForm<Scalar>::start(const Stored&) {
  for (Stored& Q : Q_) Q = identity_;
}

template <class Scalar>
void GroupForm<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  evaluate_stages(W0);
  combine(identity_, h * tableau_.b, QB_, Q_next_);
  transport(W0, Q_next_, W1);
}

template class GroupForm<double>;
template class GroupForm<Complex>;

}  // namespace isosyrk
