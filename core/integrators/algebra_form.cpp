#include "isosyrk/integrators/algebra_form.h"

#include <utility>

namespace isosyrk {

template <class Scalar>
AlgebraForm<Scalar>::AlgebraForm(SharedFlowIn<Scalar> flow, const Tableau& tableau,
                                 const IterationOptions& options, ProductBackend backend,
                                 AlgebraUpdate update)
    : Form(std::move(flow), options, backend),
      tableau_(tableau),
      update_(update),
      s_(static_cast<std::size_t>(tableau.stages())) {
  require_consistent(tableau);
  X_ = zeros(tableau.stages());
  X_old_ = X_sum_ = W_stage_ = B_ = K_row_ = X_;
  K_.assign(s_, X_);
  input_ = X_[0];
  change_.resize(3);
  adjoint_ = scratch_of_J();
}

template <class Scalar>
void AlgebraForm<Scalar>::start(const Stored& W0) {
  for (std::size_t i = 0; i < s_; ++i) {
    X_[i].setZero();
    X_sum_[i].setZero();
    W_stage_[i] = W0;
    for (Stored& K_ij : K_[i]) K_ij.setZero();
  }
}

// Each sum over stages is formed just before the product that reads it, so that it stays in cache.
// Only X and one row of K are stored twice.
template <class Scalar>
double AlgebraForm<Scalar>::sweep(const Stored& W0, double h) {
  std::swap(X_, X_old_);
  for (std::size_t i = 0; i < s_; ++i) generator(W_stage_[i], B_[i]);
  change_.setZero();
  for (std::size_t i = 0; i < s_; ++i) {
    input_ = W0 + X_sum_[i];
    products_.multiply(input_, B_[i], X_[i], -h);
    change_(0) = larger(change_(0), squared_change(X_[i], X_old_[i]));

    for (std::size_t j = 0; j < s_; ++j) {
      combine(X_sum_[i], tableau_.a.row(static_cast<Index>(j)), K_[i], input_);
      products_.multiply(B_[j], input_, K_row_[j], h);
      change_(1) = larger(change_(1), squared_change(K_row_[j], K_[i][j]));
    }
    std::swap(K_[i], K_row_);
  }
  update_stage_vorticities(W0);
  return largest_change(change_);
}

// With Y_i = Σ_j a_ij X_j:  W̃_i = W₀ + Y_i - J⁻¹ Y_i† J + Σ_j a_ij K_ij.
template <class Scalar>
void AlgebraForm<Scalar>::update_stage_vorticities(const Stored& W0) {
  for (std::size_t i = 0; i < s_; ++i) {
    const auto a_i = tableau_.a.row(static_cast<Index>(i));
    Stored& Y = X_sum_[i];
    Stored& S = input_;
    combine(a_i, X_, Y);
    combine(Y, a_i, K_[i], S);
    const double change = update_stage_vorticity(algebra(), W0, S, Y, adjoint_, W_stage_[i]);
    change_(2) = larger(change_(2), change);
  }
}

template <class Scalar>
void AlgebraForm<Scalar>::update(const Stored& W0, double h, Stored& W1) {
  if (update_ == AlgebraUpdate::two_products) return update_by_two_products(W0, h, W1);
  Stages& C = K_row_;
  for (std::size_t i = 0; i < s_; ++i) {
    generator(W_stage_[i], B_[i]);
    products_.multiply(B_[i], W_stage_[i], C[i]);
  }
  combine(h * tableau_.b, C, input_);
  add_commutator(algebra(), W0, input_, adjoint_, W1);
}

template <class Scalar>
void AlgebraForm<Scalar>::update_by_two_products(const Stored& W0, double h, Stored& W1) {
  W1 = W0;
  for (std::size_t i = 0; i < s_; ++i) {
    const double weight = h * tableau_.b(static_cast<Index>(i));
    generator(W_stage_[i], B_[i]);
    products_.multiply(B_[i], W_stage_[i], input_, weight);
    W1 += input_;
    products_.multiply(W_stage_[i], B_[i], input_, weight);
    W1 -= input_;
  }
}

template class AlgebraForm<double>;
template class AlgebraForm<Complex>;

}  // namespace isosyrk
