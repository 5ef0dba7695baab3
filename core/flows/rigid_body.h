// Free rigid bodies on any J-quadratic algebra: B multiplies each entry of W by a number.
#pragma once

#include "isosyrk/flows/flow.h"

namespace isosyrk {

/// Returns 1 / (d_i + d_j): the inverse inertia of Manakov's body.  Source: S. V. Manakov, Funct.
/// Anal. Appl. 10, 1976.
MatrixOf<double> manakov_inertia(const RealVector& d);

/// W' = [B(W), W] with
///
///     B_ij = c_ij W_ij,   H(W) = -½ Σ_ij c_ij W_ij W_ji,   c real and symmetric.
///
/// W is the angular momentum, B the angular velocity.  B = ∇H for the pairing -tr(AB), so the flow
/// is Lie-Poisson.  B maps g to g if c_ij = c_kl for all nonzero entries J_ik, J_jl: for every c if
/// J is diagonal, and for d_{i+m} = d_i if J = [[0, I], [-I, 0]] of size 2m.
class RealRigidBody final : public RealFlow {
 public:
  /// c is n x n.
  RealRigidBody(QuadraticAlgebra algebra, MatrixOf<double> c)
      : RealFlow(std::move(algebra), Generator::linear), c_(std::move(c)) {}

  void real_generator(const MatrixOf<double>& W, MatrixOf<double>& B) const override {
    B = W.cwiseProduct(c_);
  }
  double real_hamiltonian(const MatrixOf<double>& W) const override {
    return -0.5 * c_.cwiseProduct(W).cwiseProduct(W.transpose()).sum();
  }

  /// <A, B(C)> = -Σ_ij c_ij A_ji C_ij, and c is symmetric.
  bool has_self_adjoint_generator() const override { return true; }

 private:
  MatrixOf<double> c_;
};

/// The same in complex arithmetic.
class ComplexRigidBody final : public Flow {
 public:
  ComplexRigidBody(QuadraticAlgebra algebra, MatrixOf<double> c)
      : Flow(std::move(algebra), Generator::linear), c_(std::move(c)) {}

  void generator(const Matrix& W, Matrix& B) const override { B = W.cwiseProduct(c_); }
  double hamiltonian(const Matrix& W) const override {
    return -0.5 * c_.cwiseProduct(W).cwiseProduct(W.transpose()).sum().real();
  }

  bool has_self_adjoint_generator() const override { return true; }

 private:
  MatrixOf<double> c_;
};

}  // namespace isosyrk
