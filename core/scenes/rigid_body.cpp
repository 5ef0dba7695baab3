#include <fmt/format.h>

#include <stdexcept>

#include "isosyrk/flows/rigid_body.h"
#include "isosyrk/linalg/spectrum.h"
#include "isosyrk/scenes/normal_numbers.h"
#include "isosyrk/scenes/scene.h"

namespace isosyrk::scenes {

/// A rigid body in n >= 3 dimensions with Manakov's inertia, d_i from 0.5 to 2, and a random
/// angular momentum of spectral norm 1.
Scene rigid_body(const SceneParameters& parameters) {
  const Index n = parameters.n;
  if (n < 3) throw std::invalid_argument(fmt::format("n = {}: rigid_body has n >= 3", n));
  NormalNumbers normal;
  Matrix W = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = i + 1; j < n; ++j) {
      W(i, j) = normal.next();
      W(j, i) = -W(i, j);
    }
  }
  const RealVector d = RealVector::LinSpaced(n, 0.5, 2.0);
  return {"rigid_body",
          std::make_shared<RealRigidBody>(QuadraticAlgebra::skew_hermitian(n), manakov_inertia(d)),
          W / spectral_norm(W), 5.0};
}

}  // namespace isosyrk::scenes
