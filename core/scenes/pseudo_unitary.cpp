// A rigid body on su(p, q), the complex trace-free matrices with W†J + JW = 0 and
// J = diag(1, …, 1, -1, …, -1).
#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/scenes/normal_numbers.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {

/// Manakov's inertia with d_i from 0.5 to 2, which maps g to g because J is diagonal.  W = iJH -
/// itI with H = I + R, R random Hermitian of spectral norm ½, and t such that W is trace-free:
/// without it, H is positive definite and stays so.  W is scaled to spectral norm 1.  p + q = n, p
/// and q at least 1; without a signature q = n/2, rounded down.
Scene pseudo_unitary(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 2) throw std::invalid_argument(fmt::format("n = {}: pseudo_unitary has n >= 2", n));
  const auto [p, q] = parameters.signature.value_or(std::pair(n - n / 2, n / 2));
  if (p < 1 || q < 1 || p + q != n) {
    throw std::invalid_argument(fmt::format(
        "signature {},{}: must be P,Q with P >= 1, Q >= 1 and P + Q = n = {}", p, q, n));
  }
  RealVector signs = RealVector::Ones(n);
  signs.tail(q).setConstant(-1.0);
  NormalNumbers normal;
  Matrix R = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    R(i, i) = normal.next();
    for (Index j = i + 1; j < n; ++j) {
      const double real = normal.next();
      R(i, j) = Complex(real, normal.next());
      R(j, i) = std::conj(R(i, j));
    }
  }
  const Matrix H = Matrix::Identity(n, n) + 0.5 / operator_norm(R) * R;
  Matrix W = Complex(0.0, 1.0) * (signs.cast<Complex>().asDiagonal() * H);
  W.diagonal().array() -= W.trace() / static_cast<double>(n);
  W /= operator_norm(W);
  const Matrix J = signs.cast<Complex>().asDiagonal();
  return {"pseudo_unitary",
          std::make_shared<ComplexRigidBody>(QuadraticAlgebra(J),
                                             manakov_inertia(RealVector::LinSpaced(n, 0.5, 2.0))),
          W, 5.0};
}

}  // namespace isosyrk::scenes
