#include "core/algebra_form.h"

#include "core/commutator_update.h"
#include "core/stage_sums.h"

namespace isosyrk {

AlgebraForm::AlgebraForm(const Flow& flow, const Tableau& tableau, const SolverOptions& options,
                         ProductBackend backend)
    : Integrator(flow, backend),
      tableau_(tableau),
      options_(options),
      s_(static_cast<std::size_t>(tableau.stages())) {
  require_consistent(tableau);
  X_ = stage_matrices(tableau.stages(), flow.size());
  X_old_ = W_stage_ = B_ = X_sum_ = X_input_ = X_;
  K_.assign(s_, X_);
  K_old_ = K_input_ = K_;
  if (!flow.algebra().is_skew_hermitian()) adjoint_ = Matrix::Zero(flow.size(), flow.size());
}

void AlgebraForm::start(const Matrix& W0) {
  for (std::size_t i = 0; i < s_; ++i) {
    X_[i].setZero();
    W_stage_[i] = W0;
    X_input_[i] = W0;
    for (std::size_t j = 0; j < s_; ++j) {
      K_[i][j].setZero();
      K_input_[i][j].setZero();
    }
  }
}

double AlgebraForm::sweep(const Matrix& W0, double h) {
  std::swap(X_, X_old_);
  std::swap(K_, K_old_);
  for (std::size_t i = 0; i < s_; ++i) generator(W_stage_[i], B_[i]);
  for (std::size_t i = 0; i < s_; ++i) {
    products_.multiply(X_input_[i], B_[i], X_[i], -h);
    for (std::size_t j = 0; j < s_; ++j) products_.multiply(B_[j], K_input_[i][j], K_[i][j], h);
  }
  const double change = sum_stages(W0);
  return larger(change, update_stage_vorticities(W0));
}

// From the new X and K: every sum over stages that W̃ and the next sweep need, and the largest
// change of an X_i or K_ij.
double AlgebraForm::sum_stages(const Matrix& W0) {
  const Index n = flow_.size();
  double largest = 0.0;
  for (std::size_t i = 0; i < s_; ++i) {
    const auto a_i = tableau_.a.row(static_cast<Index>(i));
    double change_X = 0.0;
    for (Index r = 0; r < n; ++r) {
      change_X += squared_change(row(X_[i], r), row(X_old_[i], r));
      Row Y = row(X_sum_[i], r);
      combine_row(a_i, X_.data(), r, Y);
      row(X_input_[i], r) = row(W0, r) + Y;
      for (std::size_t j = 0; j < s_; ++j) {
        Row input = row(K_input_[i][j], r);
        combine_row(tableau_.a.row(static_cast<Index>(j)), K_[i].data(), r, input);
        input += Y;
      }
    }
    largest = larger(largest, change_X);
    for (std::size_t j = 0; j < s_; ++j) {
      double change_K = 0.0;
      for (Index r = 0; r < n; ++r) {
        change_K += squared_change(row(K_[i][j], r), row(K_old_[i][j], r));
      }
      largest = larger(largest, change_K);
    }
  }
  return std::sqrt(largest);
}

// W̃_i = W₀ + (Y_i + Σ_j a_ij K_ij) - J⁻¹ Y_i† J, where the bracket is K_input_ii; returns the
// largest change.
double AlgebraForm::update_stage_vorticities(const Matrix& W0) {
  const QuadraticAlgebra& algebra = flow_.algebra();
  double largest = 0.0;
  for (std::size_t i = 0; i < s_; ++i) {
    double change = 0.0;
    if (algebra.is_skew_hermitian()) {
      change = replace(W_stage_[i], [&](Index r, Index c) {
        return W0(r, c) + K_input_[i][i](r, c) - std::conj(X_sum_[i](c, r));
      });
    } else {
      algebra.involution(X_sum_[i], adjoint_);
      change = replace(W_stage_[i], [&](Index r, Index c) {
        return W0(r, c) + K_input_[i][i](r, c) - adjoint_(r, c);
      });
    }
    largest = larger(largest, change);
  }
  return std::sqrt(largest);
}

void AlgebraForm::update(const Matrix& W0, double h, Matrix& W1) {
  for (std::size_t i = 0; i < s_; ++i) {
    generator(W_stage_[i], B_[i]);
    products_.multiply(B_[i], W_stage_[i], X_old_[i]);
  }
  const auto b = h * tableau_.b.array();
  for (Index r = 0; r < flow_.size(); ++r) {
    Row sum = row(X_sum_[0], r);
    combine_row(b, X_old_.data(), r, sum);
  }
  add_commutator(flow_.algebra(), W0, X_sum_[0], adjoint_, W1);
}

SolveReport AlgebraForm::advance(const Matrix& W0, double h, Matrix& W1) {
  start(W0);
  const SolveReport report = solve_fixed_point(options_, [&] { return sweep(W0, h); });
  if (report.status == Status::converged) update(W0, h, W1);
  return report;
}

}  // namespace isosyrk
