// A rigid body on sp(2m), the real matrices with WᵀJ + JW = 0, J = [[0, I], [-I, 0]].
#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/scenes/normal_numbers.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {

/// Manakov's inertia with d = (d_1 .. d_m, d_1 .. d_m), d_i from 0.5 to 2, which maps g to g
/// because J joins i and i + m only.  W = JS with a symmetric S = I + R, R random of spectral norm
/// ½: S is positive definite and stays so, and W has eigenvalues ±iω.  W is scaled to spectral
/// norm 1.
Scene symplectic(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 4 || n % 2 != 0) {
    throw std::invalid_argument(fmt::format("n = {}: symplectic has an even n >= 4", n));
  }
  const Index m = n / 2;
  Matrix J = Matrix::Zero(n, n);
  J.topRightCorner(m, m).setIdentity();
  J.bottomLeftCorner(m, m) = -J.topRightCorner(m, m);
  NormalNumbers normal;
  Matrix S = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = i; j < n; ++j) S(i, j) = S(j, i) = normal.next();
  }
  S = Matrix::Identity(n, n) + 0.5 / operator_norm(S) * S;
  S /= operator_norm(S);
  // J S without a product, so that imaginary parts are exactly 0.
  Matrix W(n, n);
  W.topRows(m) = S.bottomRows(m);
  W.bottomRows(m) = -S.topRows(m);
  const RealVector d = RealVector::LinSpaced(m, 0.5, 2.0).replicate(2, 1);
  return {"symplectic", std::make_shared<RealRigidBody>(QuadraticAlgebra(J), manakov_inertia(d)), W,
          5.0};
}

}  // namespace isosyrk::scenes
