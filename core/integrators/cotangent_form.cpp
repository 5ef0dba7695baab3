#include "isosyrk/integrators/cotangent_form.h"

namespace isosyrk {

template <class Scalar>
CotangentForm<Scalar>::CotangentForm(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                                     const IterationOptions& options, ProductBackend backend)
    : Form(std::move(flow), options, backend), tableau_(tableau) {
  require_consistent(tableau);
  Q_ = zeros(tableau.stages());
  P_ = QB_ = PB_ = Q_;
  W_stage_ = B_ = Q_next_ = P_next_ = zero();
  identity_ = identity();
  change_.resize(Index{2} * tableau.stages());
}

// QB_j = Q_j B(W̃_j)† and PB_j = P_j B(W̃_j) from the current Q_j and P_j.
template <class Scalar>
void CotangentForm<Scalar>::evaluate_stages() {
  for (std::size_t j = 0; j < Q_.size(); ++j) {
    products_.multiply_adjoint_left(Q_[j], P_[j], W_stage_);
    generator(W_stage_, B_);
    products_.multiply_adjoint_right(Q_[j], B_, QB_[j]);
    products_.multiply(P_[j], B_, PB_[j]);
  }
}

template <class Scalar>
double CotangentForm<Scalar>::sweep(const Stored& W0, double h) {
  evaluate_stages();
  const Index s = tableau_.stages();
  update_unknowns(identity_, h, tableau_.a, QB_, Q_, change_.data());
  update_unknowns(W0, -h, tableau_.a, PB_, P_, change_.data() + s);
  return largest_change(change_);
}

template <class Scalar>
void CotangentForm<Scalar>::start(const Stored& W0) {
  for (Stored& Q : Q_) Q = identity_;
  for (Stored& P : P_) P = W0;
}

template <class Scalar>
void CotangentForm<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  evaluate_stages();
  combine(identity_, h * tableau_.b, QB_, Q_next_);
  combine(W0, -h * tableau_.b, PB_, P_next_);
  products_.multiply_adjoint_left(Q_next_, P_next_, W1);
}

template class CotangentForm<double>;
template class CotangentForm<Complex>;

}  // namespace isosyrk
